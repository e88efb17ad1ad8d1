#include "tools/sinew/train_net.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "components/actuator/file/model_file.h"
#include "components/config/config.h"
#include "components/networks/dataset/dataset.h"
#include "components/networks/file/model_file.h"
#include "components/networks/model.h"
#include "components/recording/file/recording_path.h"
#include "components/recording/file/run_reader.h"
#include "tools/sinew/progress.h"
#include "tools/training_sets/training_sets.h"

namespace sinew::tools {
namespace {

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

networks::PublishedModel PlanOf(const TrainNetOptions& options, int measured) {
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

std::vector<types::Run> RunsOf(const TrainNetOptions& options, networks::Task task) {
  if (options.recordings.empty()) {
    return {MakeSurrogateRun({.task = task, .seed = options.seed})};
  }
  std::vector<types::Run> runs;
  for (const std::filesystem::path& path : options.recordings) {
    for (types::Run& run : recording::ReadRuns(
             path, options.map, recording::ParseRecordingPath(path).IsMcap() ? options.joint : 0)) {
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

}  // namespace

std::vector<std::string> NetNames() {
  std::vector<std::string> names;
  for (const auto& [name, place] : Places()) names.push_back(name);
  return names;
}

void TrainNet(const TrainNetOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const networks::Task task = options.task == "sea"   ? networks::Task::kSea
                              : options.task == "pea" ? networks::Task::kPea
                                                      : networks::Task::kForce;
  const networks::TaskInfo& info = networks::InfoOf(task);
  networks::TableConfig table{.task = task, .period_s = options.period_s};
  if (!options.model.empty()) {
    const actuator::RobotModel robot = actuator::LoadRobotModel(options.model);
    if (options.joint < 0 || options.joint >= static_cast<int>(robot.joints.size())) {
      throw UsageError(options.model.string() + ": key 'joints': has " +
                       std::to_string(robot.joints.size()) + " joints, expected joint " +
                       std::to_string(options.joint) + " of --joint");
    }
    const auto& constants = robot.joints[static_cast<std::size_t>(options.joint)].constants;
    table.gear_ratio = constants.gear_ratio;
    table.link_length_m = constants.link_length_m;
  }
  networks::FitResult result;
  networks::PublishedModel plan;
  networks::Samples samples;
  try {
    const std::vector<types::Run> runs = RunsOf(options, task);
    samples = networks::MakeSamples(networks::MakeTable(runs, table),
                                    options.patience > 0 ? kValidationShare : 0.0, kGap);
    plan = PlanOf(options, static_cast<int>(samples.inputs.rows()));
    ProgressBar bar("train", "epochs", static_cast<std::uint64_t>(plan.training.epochs));
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
  networks::SaveModel(options.out, model);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double scale = model.output.scale(0);
  if (options.json) {
    const nlohmann::ordered_json json = {{"net", options.net},
                                         {"task", options.task},
                                         {"model", options.out.string()},
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
                                         {"time_s", seconds}};
    std::cout << json.dump(2) << '\n';
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
  std::printf("%s written, %.2f s\n", options.out.string().c_str(), seconds);
}

}  // namespace sinew::tools
