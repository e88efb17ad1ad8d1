// `sinew train`: a network from recordings of the robot.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sinew::tools {

struct TrainOptions {
  std::filesystem::path model;
  std::vector<std::filesystem::path> recordings;
  std::vector<std::filesystem::path> tests;
  std::filesystem::path map;
  std::filesystem::path config;
  std::filesystem::path out;
  std::string network;
  int joint = 0;
  bool json = false;
};

// Networks beside the echo state networks of a configuration, selected by an option of their own.
struct OtherNetworks {
  std::string help;      // of the command, with its examples below
  std::string examples;  // lines
  // Adds options to the command and returns the one that selects these networks.
  std::function<CLI::Option*(CLI::App& train)> add_options;
  // Throws UsageError, CLI::Error.
  std::function<void(const TrainOptions& options)> train;
};

// Errors are shares of the target's variance: the mean of the target, said at every sample, has 1.
inline bool IsWorseThanTheMean(double mse_normalised) { return !(mse_normalised < 1.0); }
// Warns on stderr of a network that is, by its error on the test samples.
void WarnOfWorseThanTheMean(double mse_normalised);

// others: nothing where none are built.
void AddTrainCommand(CLI::App& app, const OtherNetworks& others = {});

}  // namespace sinew::tools
