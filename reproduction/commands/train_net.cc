#include "reproduction/commands/train_net.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/actuator/file/model_file.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/file/run_reader.h"
#include "reproduction/networks/dataset/dataset.h"
#include "reproduction/networks/file/model_file.h"
#include "reproduction/networks/model.h"
#include "reproduction/training_sets/training_sets.h"
#include "tools/sinew/progress.h"

namespace sinew::reproduction {
namespace {

struct NetOptions {
  std::string net;   // "lstm", "wiener-esn", ...
  std::string task;  // "sea", "pea", "force"
  int epochs = 0;    // 0: as published
  int batch = 0;
  double rate = 0.0;
  int patience = 0;
  double period_s = 0.0125;
  bool gcv = false;
  std::uint64_t seed = 1;
};

// Where the published settings are taken from: table 6.2 or 6.4, and the model's name there.
struct Place {
  const char* name;
  bool pea;
};
const std::map<std::string, Place>& Places() {
  static const std::map<std::string, Place> kPlaces = {
      {"lstm", {"LSTM", false}},
      {"gru", {"GRU", false}},
      {"ffnn", {"FFNN", false}},
      {"nnx", {"NNX", false}},
      {"esn", {"ESN", false}},
      {"linear", {"Pure linear", true}},
      {"pure-lstm", {"Pure LSTM", true}},
      {"pure-esn", {"Pure ESN", true}},
      {"wiener-lstm", {"Wiener LSTM", true}},
      {"wiener-ffnn", {"Wiener FFNN", true}},
      {"wiener-ffnn-big", {"Wiener FFNN big", true}},
      {"wiener-esn", {"Wiener ESN", true}}};
  return kPlaces;
}

networks::PublishedModel PlanOf(const NetOptions& options, int measured) {
  const Place& place = Places().at(options.net);
  networks::PublishedModel plan;
  for (const networks::PublishedModel& model :
       place.pea ? networks::Table64() : networks::Table62()) {
    if (model.name == place.name) plan = model;
  }
  plan.net.inputs = measured + (plan.wiener ? 1 : 0);
  if (options.epochs > 0) plan.training.epochs = options.epochs;
  if (options.batch > 0) plan.training.batch = options.batch;
  if (options.rate > 0.0) plan.training.adam.rate = options.rate;
  plan.training.patience = options.patience;
  if (options.gcv) plan.reservoir.ridge_beta.reset();
  return plan;
}

// Without recordings: the surrogate's set.
std::vector<types::Run> RunsOf(const tools::TrainOptions& data, networks::Task task,
                               std::uint64_t seed) {
  if (data.recordings.empty()) return {MakeSurrogateRun({.task = task, .seed = seed})};
  std::vector<types::Run> runs;
  for (const std::filesystem::path& path : data.recordings) {
    for (types::Run& run : recording::ReadRuns(
             path, data.map, recording::ParseRecordingPath(path).IsMcap() ? data.joint : 0)) {
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

// Names for --net.
std::vector<std::string> NetNames() {
  std::vector<std::string> names;
  for (const auto& [name, place] : Places()) names.push_back(name);
  return names;
}

// data.model: gear ratio and link length; empty: the rig's.
void TrainNet(const NetOptions& options, const tools::TrainOptions& data) {
  const auto start = std::chrono::steady_clock::now();
  const networks::Task task = options.task == "sea"   ? networks::Task::kSea
                              : options.task == "pea" ? networks::Task::kPea
                                                      : networks::Task::kForce;
  const networks::TaskInfo& info = networks::InfoOf(task);
  networks::TableConfig table{.task = task, .period_s = options.period_s};
  if (!data.model.empty()) {
    const actuator::RobotModel robot = actuator::LoadRobotModel(data.model);
    if (data.joint < 0 || data.joint >= static_cast<int>(robot.joints.size())) {
      throw UsageError(data.model.string() + ": key 'joints': has " +
                       std::to_string(robot.joints.size()) + " joints, expected joint " +
                       std::to_string(data.joint) + " of --joint");
    }
    const auto& constants = robot.joints[static_cast<std::size_t>(data.joint)].constants;
    table.gear_ratio = constants.gear_ratio;
    table.link_length_m = constants.link_length_m;
  }
  networks::FitResult result;
  networks::PublishedModel plan;
  networks::Samples samples;
  try {
    const std::vector<types::Run> runs = RunsOf(data, task, options.seed);
    samples = networks::MakeSamples(networks::MakeTable(runs, table),
                                    options.patience > 0 ? kValidationShare : 0.0, kGap);
    plan = PlanOf(options, static_cast<int>(samples.inputs.rows()));
    tools::ProgressBar bar("train", "epochs", static_cast<std::uint64_t>(plan.training.epochs));
    result = networks::Fit(plan, samples, info.linear, options.seed,
                           [&](const networks::TrainProgress& progress) {
                             bar.Update(static_cast<std::uint64_t>(progress.epoch));
                             return true;
                           });
    bar.Finish();
    for (const types::Run& run : runs) {
      std::string& hash = result.model.training_data_hash;
      hash += (hash.empty() ? "" : "+") + run.content_hash;
    }
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  networks::Model& model = result.model;
  model.task = info.name;
  for (const std::string_view name : info.inputs) model.inputs.emplace_back(name);
  model.target = info.target;
  model.period_s = options.period_s;
  networks::SaveModel(data.out, model);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double scale = model.output.scale(0);
  const double test_error = samples.test.size() > 0 ? result.test_mse : 0.0;
  if (data.json) {
    const nlohmann::ordered_json json = {{"net", options.net},
                                         {"task", options.task},
                                         {"model", data.out.string()},
                                         {"parameters", model.parameter_count()},
                                         {"target", model.target},
                                         {"inputs", model.inputs},
                                         {"epochs", result.training.epochs},
                                         {"ridge_beta", model.ridge_beta},
                                         {"train",
                                          {{"samples", samples.train.size()},
                                           {"mse_normalised", result.train_mse},
                                           {"rms", scale * std::sqrt(result.train_mse)}}},
                                         {"test",
                                          {{"samples", samples.test.size()},
                                           {"mse_normalised", result.test_mse},
                                           {"rms", scale * std::sqrt(result.test_mse)}}},
                                         {"worse_than_mean", tools::IsWorseThanTheMean(test_error)},
                                         {"time_s", seconds}};
    std::cout << types::JsonText(json, 2) << '\n';
    return;
  }
  const std::string unit(info.unit);
  std::printf("%s for %s: %d parameters, target %s\n", plan.name.c_str(), options.task.c_str(),
              model.parameter_count(), model.target.c_str());
  std::printf("inputs ");
  for (const std::string& name : model.inputs) std::printf(" %s", name.c_str());
  std::printf("\n");
  if (plan.method == networks::Method::kNet) {
    std::printf("adam   %d epochs%s, rate %g, batch %d\n", result.training.epochs,
                result.training.diverged ? " (diverged, the last good weights kept)" : "",
                plan.training.adam.rate, plan.training.batch);
  } else if (plan.method == networks::Method::kReservoir) {
    std::printf("ridge  beta %.3g%s\n", model.ridge_beta,
                options.gcv ? " by generalised cross-validation" : "");
  }
  std::printf("train  MSE %.5f of the variance, rms %.5f %s, %zu samples\n", result.train_mse,
              scale * std::sqrt(result.train_mse), unit.c_str(), samples.train.size());
  std::printf("test   MSE %.5f of the variance, rms %.5f %s, %zu samples\n", result.test_mse,
              scale * std::sqrt(result.test_mse), unit.c_str(), samples.test.size());
  std::fflush(stdout);
  tools::WarnOfWorseThanTheMean(test_error);
  std::printf("%s written, %.2f s\n", data.out.string().c_str(), seconds);
}

// What --net does not read, or needs beside it.
void Check(const NetOptions& options, const tools::TrainOptions& data) {
  if (options.task.empty()) throw CLI::RequiredError("--task");
  if (options.task == "force" && data.recordings.empty()) {
    throw CLI::RequiredError("a recording (the surrogate has no cylinder)");
  }
  if (!data.tests.empty() || !data.network.empty() || !data.config.empty()) {
    throw CLI::ExcludesError("--net", "--test, --network, --config");
  }
}

CLI::Option* AddOptions(CLI::App& train, NetOptions* net) {
  CLI::Option* kind = train.add_option("--net", net->net, "One of the published models")
                          ->check(CLI::IsMember(NetNames()));
  const auto with_net = [kind](CLI::Option* option) { return option->needs(kind); };
  with_net(train.add_option("--task", net->task, "With --net: inputs, target and data set"))
      ->check(CLI::IsMember({"sea", "pea", "force"}));
  with_net(train.add_option("--epochs", net->epochs, "Instead of the published ones"))
      ->check(CLI::Range(1, 1000000));
  with_net(train.add_option("--batch", net->batch, "Samples an update, instead of as published"))
      ->check(CLI::Range(1, 10000000));
  with_net(train.add_option("--rate", net->rate, "Of Adam, instead of 0.001"))
      ->check(CLI::Range(1e-9, 1.0));
  with_net(train.add_option("--patience", net->patience,
                            "Stop after so many epochs without a better validation error"))
      ->check(CLI::Range(1, 1000000));
  with_net(train.add_option("--period", net->period_s, "Of a sample, s"))
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  with_net(train.add_flag("--gcv", net->gcv, "Ridge strength by cross-validation"));
  with_net(train.add_option("--seed", net->seed, "Of weights, batches and the surrogate"));
  return kind;
}

}  // namespace

tools::OtherNetworks MakePublishedNetworks() {
  const auto net = std::make_shared<NetOptions>();
  return {
      .help =
          "Without --net: an echo state network as the configuration says, for sinew-esn. "
          "With --net:\n"
          "one of the published models, from recordings or, without them, from the "
          "surrogate.\n",
      .examples =
          "  sinew train --net wiener-esn --task pea --out wiener_esn.json\n"
          "  sinew train run.mcap --net lstm --task sea --patience 50 --out "
          "lstm.json",
      .add_options = [net](CLI::App& train) { return AddOptions(train, net.get()); },
      .train =
          [net](const tools::TrainOptions& data) {
            Check(*net, data);
            TrainNet(*net, data);
          },
  };
}

}  // namespace sinew::reproduction
