#include "tools/sinew/train.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/learn/esn/dataset/dataset.h"
#include "components/learn/esn/dataset/file/training_file.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/learn/esn/training.h"
#include "components/model/actuator/file/model_file.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/file/ros_bag.h"
#include "components/record/recording/file/run_reader.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {
namespace {

std::vector<types::Run> ReadAll(const std::vector<std::filesystem::path>& paths,
                                const TrainOptions& options, int joint) {
  std::vector<types::Run> runs;
  for (const std::filesystem::path& path : paths) {
    const recording::RecordingPath given = recording::ParseRecordingPath(path);
    const bool csv = !given.IsMcap() && !recording::IsRosBag(given.file);
    for (types::Run& run : recording::ReadRuns(path, options.map, csv ? 0 : joint)) {
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

// Recordings as the plan wants them: of --joint, or of all joints of the model.
struct TrainingRuns {
  const esn::NetworkPlan* plan;
  const actuator::RobotModel* robot;
  const TrainOptions* options;

  esn::Dataset Make(const std::vector<std::filesystem::path>& paths,
                    const esn::DatasetConfig& config, bool test_only, std::string* hash) const {
    std::vector<std::vector<types::Run>> runs;
    if (!plan->all_joints) {
      runs.push_back(ReadAll(paths, *options, options->joint));
    } else {
      for (std::size_t j = 0; j < robot->joints.size(); ++j) {
        runs.push_back(ReadAll(paths, *options, static_cast<int>(j)));
      }
    }
    if (hash != nullptr) {
      for (const std::vector<types::Run>& of_joint : runs) {
        for (const types::Run& run : of_joint) {
          *hash += (hash->empty() ? "" : "+") + run.content_hash;
        }
      }
    }
    if (plan->all_joints) return esn::MakeRobotDataset(runs, robot->joints, config, test_only);
    return esn::MakeDataset(runs[0], robot->joints[static_cast<std::size_t>(options->joint)],
                            config, test_only);
  }
};

struct Outcome {
  esn::TrainingResult result;
  esn::Dataset data;
  std::vector<std::string> outputs;  // joints
  double seconds = 0.0;
};

Outcome TrainNetwork(const TrainOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const esn::NetworkPlan plan = esn::LoadNetworkPlan(options.config, options.network);
  const actuator::RobotModel robot = actuator::LoadRobotModel(options.model);
  if (options.joint < 0 || options.joint >= static_cast<int>(robot.joints.size())) {
    throw UsageError(options.model.string() + ": key 'joints': has " +
                     std::to_string(robot.joints.size()) + " joints, expected joint " +
                     std::to_string(options.joint) + " of --joint");
  }
  const TrainingRuns runs{&plan, &robot, &options};
  Outcome outcome;
  std::string hash;
  try {
    outcome.data = runs.Make(options.recordings, plan.dataset, false, &hash);
    std::vector<esn::Sequence> sequences = outcome.data.sequences;
    if (!options.tests.empty()) {
      // The test is elsewhere: everything here teaches.
      for (esn::Sequence& sequence : sequences) {
        for (esn::Use& use : sequence.use) {
          if (use == esn::Use::kTest) use = esn::Use::kTrain;
        }
      }
      // The play's centre is a fact of the rig, not of a recording.
      esn::DatasetConfig test_plan = plan.dataset;
      test_plan.play_centre_rad = outcome.data.play_centre_rad;
      const esn::Dataset test = runs.Make(options.tests, test_plan, true, nullptr);
      sequences.insert(sequences.end(), test.sequences.begin(), test.sequences.end());
    }
    outcome.result = esn::Train(sequences, plan.training);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  esn::Weights& weights = outcome.result.weights;
  weights.network = plan.name;
  weights.target = esn::TargetName(plan.dataset.target);
  weights.inputs = plan.all_joints ? esn::InputsOfRobot(plan.dataset.inputs,
                                                        static_cast<int>(robot.joints.size()))
                                   : esn::InputsOfJoint(plan.dataset.inputs, options.joint);
  weights.training_data_hash = hash;
  for (const actuator::JointModel& joint : robot.joints) {
    if (plan.all_joints) outcome.outputs.push_back(joint.name);
  }
  if (!plan.all_joints) {
    outcome.outputs.push_back(robot.joints[static_cast<std::size_t>(options.joint)].name);
  }
  esn::SaveWeights(options.out, weights);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

void PrintScore(const char* name, const esn::Score& score) {
  if (score.samples == 0) {
    Print("%-6s no samples\n", name);
    return;
  }
  const double mse = score.mse.mean();
  Print("%-6s MSE %.6f Nm^2, rms %.4f Nm, %.4f %% of the target's variance, %ld samples\n", name,
        mse, std::sqrt(mse), 100.0 * score.normalised.mean(), score.samples);
}

nlohmann::ordered_json ScoreJson(const esn::Score& score) {
  if (score.samples == 0) return nullptr;
  return {{"samples", score.samples},
          {"mse_Nm2", score.mse.mean()},
          {"normalised", score.normalised.mean()}};
}

// 0 without samples: nothing is known then.
double ErrorOf(const esn::Score& score) {
  return score.samples > 0 ? score.normalised.mean() : 0.0;
}

void PrintOutcome(const TrainOptions& options, const Outcome& outcome) {
  const esn::TrainingResult& result = outcome.result;
  const esn::Weights& weights = result.weights;
  if (options.json) {
    const nlohmann::ordered_json json = {
        {"network", weights.network},
        {"weights", options.out.string()},
        {"parameters", weights.readout.size()},
        {"neurons", weights.neurons()},
        {"inputs", weights.input_count()},
        {"ridge_beta", weights.ridge_beta},
        {"effective_parameters", result.effective_parameters},
        {"recorded_s", outcome.data.duration_s},
        {"samples", outcome.data.samples},
        {"samples_inside_backlash", outcome.data.inside},
        {"play_centre_rad", outcome.data.play_centre_rad},
        {"train", ScoreJson(result.train)},
        {"test", ScoreJson(result.test)},
        {"worse_than_mean", IsWorseThanTheMean(ErrorOf(result.test))},
        {"time_s", outcome.seconds}};
    std::cout << types::JsonText(json, 2) << '\n';
    return;
  }
  Print("network '%s': %d parameters (1 + %d inputs + %d neurons), target %s\n",
        weights.network.c_str(), static_cast<int>(weights.readout.size()), weights.input_count(),
        weights.neurons(), weights.target.c_str());
  Print(
      "data   %.1f s, %ld samples at %.0f Hz, %ld of them inside the backlash (centre %.5f rad)\n",
      outcome.data.duration_s, outcome.data.samples, 1.0 / weights.period_s, outcome.data.inside,
      outcome.data.play_centre_rad);
  Print("ridge  beta %.3g%s\n", weights.ridge_beta,
        result.gcv.empty() ? "" : " by generalised cross-validation");
  PrintScore("train", result.train);
  PrintScore("test", result.test);
  WarnOfWorseThanTheMean(ErrorOf(result.test));
  for (std::size_t j = 0; outcome.outputs.size() > 1 && j < outcome.outputs.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    Print("       %-20s rms %.4f Nm of the training samples", outcome.outputs[j].c_str(),
          std::sqrt(result.train.mse(k)));
    if (result.test.samples > 0) {
      Print(", %.4f Nm of the test, %.4f %% of the variance", std::sqrt(result.test.mse(k)),
            100.0 * result.test.normalised(k));
    }
    Print("\n");
  }
  Print("%s written, %.2f s\n", options.out.string().c_str(), outcome.seconds);
}

}  // namespace

void WarnOfWorseThanTheMean(double mse_normalised) {
  if (!IsWorseThanTheMean(mse_normalised)) return;
  std::cerr << "warning: on the test samples this network is worse than the target's mean, that "
               "is, than none: longer or richer recordings, fewer neurons, or other inputs\n";
}

void AddTrainCommand(CLI::App& app, const OtherNetworks& others) {
  CLI::App* command = app.add_subcommand("train", "Train a network on recordings");
  const std::string help = others.help.empty()
                               ? "An echo state network as the configuration says, for sinew-esn.\n"
                               : others.help;
  command->footer(help +
                  "Example:\n"
                  "  sinew train run.mcap --model robots/rig/model.yaml --network pea \\\n"
                  "    --config robots/rig/esn_train.yaml --out pea.json" +
                  (others.examples.empty() ? "" : "\n" + others.examples));
  auto options = std::make_shared<TrainOptions>();
  CLI::Option* model =
      command->add_option("--model", options->model, "Model file: gear ratio, backlash, drive");
  AddRecordings(*command, "--recording", &options->recordings, "MCAP, or CSV with --map");
  command->add_option("--test", options->tests,
                      "Recording to test on, instead of blocks of the others");
  command->add_option("--map", options->map, "Mapping file of CSV recordings");
  CLI::Option* network = command->add_option(
      "--network", options->network, "Name of the network in the configuration, e.g. sea or pea");
  CLI::Option* config =
      command->add_option("--config", options->config, "What to train and how (sinew-esn-train/1)");
  command->add_option("--out", options->out, "Weights file to write")->required();
  command->add_option("--joint", options->joint, "Index of the joint in messages and model")
      ->check(CLI::Range(0, 11));
  const CLI::Option* other = others.add_options ? others.add_options(*command) : nullptr;
  command->add_flag("--json", options->json, "Result as JSON");
  command->callback([options, train = others.train, model, network, config, other] {
    if (other != nullptr && other->count() > 0) {
      train(*options);
      return;
    }
    if (options->recordings.empty()) throw CLI::RequiredError("a recording");
    for (const CLI::Option* needed : {model, network, config}) {
      if (needed->count() == 0) throw CLI::RequiredError(needed->get_name());
    }
    PrintOutcome(*options, TrainNetwork(*options));
  });
}

}  // namespace sinew::tools
