#include "reproduction/legs_table/legs_data.h"

#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "components/learn/esn/dataset/dataset.h"
#include "components/model/actuator/file/model_file.h"
#include "components/record/recording/file/run_reader.h"
#include "reproduction/recorded_run/recorded_run.h"
#include "reproduction/training_sets/training_sets.h"

namespace sinew::reproduction {
namespace {

namespace fs = std::filesystem;

constexpr double kTrainShare = 0.8;  // the source's split

bool IsPitchJoint(const std::string& name) {
  return name.find("pitch") != std::string::npos || name.find("knee") != std::string::npos;
}

}  // namespace

fs::path RecordChirp(const LegsRecording& options) {
  fs::create_directories(options.folder);
  RecordedRun run;
  run.name = "chirp squat";
  run.recording = fs::absolute(options.folder) / "chirp.mcap";
  if (fs::exists(run.recording)) return run.recording;
  const fs::path robot = fs::absolute(options.robot);
  run.deployment = robot / "deploy_biped.yaml";
  run.overrides.settings = {"duration_s=" + std::to_string(options.duration_s),
                            "domain_id=" + std::to_string(options.domain_id),
                            "reference.config=" + (robot / "reference_chirp.yaml").string()};
  run.log = run.recording.parent_path() / "processes.log";
  run.programs = options.programs;
  RunRecorded(run);
  return run.recording;
}

std::vector<LegsData> ReadLegsData(const fs::path& recording, const fs::path& robot) {
  const actuator::RobotModel model = actuator::LoadRobotModel(robot / "model.yaml");
  esn::DatasetConfig config;
  config.inputs = {esn::Signal::kReferencePosition, esn::Signal::kReferenceVelocity,
                   esn::Signal::kReferenceAcceleration};
  config.derivatives_from_motor = true;
  config.blocks = 1;
  config.train_share = kTrainShare;
  std::vector<std::vector<types::Run>> all_runs, pitch_runs;
  std::vector<actuator::JointModel> all_models, pitch_models;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    all_runs.push_back(recording::ReadRuns(recording, {}, static_cast<int>(j)));
    all_models.push_back(model.joints[j]);
    if (!IsPitchJoint(model.joints[j].name)) continue;
    pitch_runs.push_back(all_runs.back());
    pitch_models.push_back(model.joints[j]);
  }
  const auto make = [&](const std::vector<std::vector<types::Run>>& runs,
                        const std::vector<actuator::JointModel>& models) {
    const esn::Dataset set = esn::MakeRobotDataset(runs, models, config);
    return LegsData{static_cast<int>(models.size()), networks::MakeSamples(set.sequences),
                    networks::MakeSamples(set.sequences, kValidationShare, kGap)};
  };
  try {
    return {make(all_runs, all_models), make(pitch_runs, pitch_models)};
  } catch (const std::invalid_argument& error) {
    throw UsageError(recording.string() + ": " + error.what());
  }
}

}  // namespace sinew::reproduction
