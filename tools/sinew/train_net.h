// `sinew train --net`: any of the published models, from recordings or the surrogate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sinew::tools {

struct TrainNetOptions {
  std::string net;                                // "lstm", "wiener-esn", ...
  std::string task;                               // "sea", "pea", "force"
  std::vector<std::filesystem::path> recordings;  // empty: the surrogate's set
  std::filesystem::path map;
  std::filesystem::path model;  // gear ratio and link length; empty: the rig's
  std::filesystem::path out;
  int joint = 0;
  int epochs = 0;  // 0: as published
  int batch = 0;
  double rate = 0.0;
  int patience = 0;
  double period_s = 0.0125;
  bool gcv = false;
  std::uint64_t seed = 1;
  bool json = false;
};

// Names for --net.
std::vector<std::string> NetNames();

// Throws UsageError.
void TrainNet(const TrainNetOptions& options);

}  // namespace sinew::tools
