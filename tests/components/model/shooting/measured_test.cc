// Two measured pendulums by simulation (docs/real-data.md): the declared model, the torque
// balance's refit and the fit by simulation are compared by the simulated angle on recordings of no
// fit. Skipped where the data are not there.
#include <gtest/gtest.h>

#include <filesystem>

#include "components/model/actuator/file/model_file.h"
#include "components/model/shooting/close_by_simulation.h"
#include "components/model/shooting/shooting_fit.h"
#include "components/record/recording/file/run_reader.h"
#include "sim/plant/joint_body.h"
#include "tests/support/skip.h"

namespace sinew::shooting {
namespace {

namespace fs = std::filesystem;

const fs::path kRobots = fs::path(SINEW_SOURCE_DIR) / "robots";
const fs::path kMeasured = fs::path(SINEW_SHARED_DIR) / "data";

struct Errors {
  double declared = 0.0, by_torque = 0.0, by_simulation = 0.0, corrected = 0.0;  // rad rms
};

// The held-out recordings by each model, start states fitted.
Errors HeldOut(const std::string& robot, const fs::path& folder,
               const std::vector<std::string>& train, const std::vector<std::string>& held_out) {
  const actuator::JointModel joint =
      actuator::LoadRobotModel(kRobots / robot / "model.yaml").joints.front();
  const auto read = [&](const std::vector<std::string>& files) {
    std::vector<types::Run> runs;
    for (const std::string& file : files) {
      for (types::Run& run :
           recording::ReadRuns(folder / file, kRobots / robot / "csv_map.yaml", 0)) {
        runs.push_back(std::move(run));
      }
    }
    return runs;
  };
  const std::vector<types::Run> trained = read(train), tested = read(held_out);
  const trace::TraceResult torque = trace::CloseLoop(trained, tested, joint, 0.25, {}).trace;
  const trace::LoopResult loop =
      CloseBySimulation(trained, tested, joint, 0.25, {}, plant::JointAlone());
  const Recordings recordings(tested, joint, loop.processing, plant::JointAlone(), {});
  const Errors out{loop.trace.nominal_held_out.rms, FitStart(recordings, torque.declared).rms,
                   loop.trace.before_held_out.rms, loop.trace.after_held_out.rms};
  const Recordings training(trained, joint, loop.processing, plant::JointAlone(), {});
  std::cout << robot << ": training, rad rms: " << FitStart(training, torque.declared).rms
            << " by torque, " << loop.trace.before_train.rms << " by simulation, "
            << loop.trace.after_train.rms << " corrected\n";
  std::cout << robot << ": held out, rad rms: " << out.declared << " declared, " << out.by_torque
            << " by torque, " << out.by_simulation << " by simulation, " << out.corrected
            << " corrected\n";
  for (const auto* list : {&loop.trace.effects, &loop.trace.open, &loop.trace.refuted}) {
    for (const trace::FoundEffect& found : *list) {
      std::cout << "  " << found.name << ' ' << trace::ConfirmationWord(found.confirmation.verdict)
                << '\n';
    }
  }
  return out;
}

TEST(MeasuredBySimulation, SwingUpsOfTheAk80) {
  const fs::path folder = kMeasured / "dfki_pendulum_ak80_6";
  SKIP_WITHOUT_DATA(folder);
  const Errors errors =
      HeldOut("dfki_pendulum", folder, {"ddp_measured.csv"}, {"dircol_measured.csv"});
  EXPECT_LT(errors.by_simulation, 0.5 * errors.declared);
  EXPECT_LT(errors.by_simulation, errors.by_torque);
}

TEST(MeasuredBySimulation, FreeSwingsOfTheAk80) {
  const fs::path folder = kMeasured / "dfki_pendulum_ak80_6";
  SKIP_WITHOUT_DATA(folder);
  const Errors errors = HeldOut("dfki_pendulum", folder, {"energy_shaping_measured.csv@:12"},
                                {"energy_shaping_measured.csv@12:"});
  EXPECT_LT(errors.by_simulation, errors.declared);
  EXPECT_LT(errors.by_simulation, errors.by_torque);
}

TEST(MeasuredBySimulation, TheXl330InClosedLoop) {
  const fs::path folder = kMeasured / "bam_xl330_pendulum";
  SKIP_WITHOUT_DATA(folder);
  std::vector<std::string> train, held_out;
  for (const char* motion : {"lift_and_drop", "sin_sin", "sin_time_square", "up_and_down"}) {
    train.push_back(std::string("kp100_") + motion + ".csv");
    train.push_back(std::string("kp800_") + motion + ".csv");
    held_out.push_back(std::string("kp200_") + motion + ".csv");
  }
  const Errors errors = HeldOut("bam_xl330", folder, train, held_out);
  EXPECT_LT(errors.by_simulation, errors.declared);
  EXPECT_LE(errors.corrected, 1.01 * errors.by_simulation);
}

}  // namespace
}  // namespace sinew::shooting
