// The gate on recordings that others made: none of them may be stopped, and what is planted into
// them has to be found.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "components/model/actuator/file/model_file.h"
#include "components/model/gate/gate.h"
#include "components/record/recording/file/run_reader.h"
#include "tests/components/model/gate/plant.h"
#include "tests/support/temporary_folder.h"

namespace sinew::gate {
namespace {

namespace fs = std::filesystem;

struct Set {
  actuator::JointModel model;
  std::vector<types::Run> runs;
};

std::vector<fs::path> CsvFiles(const fs::path& folder, const std::string& prefix = "") {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".csv" && name.starts_with(prefix)) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

Set Load(const fs::path& model, const fs::path& map, const std::vector<fs::path>& files,
         std::size_t joint = 0) {
  Set out;
  out.model = actuator::LoadRobotModel(model).joints.at(joint);
  for (const fs::path& file : files) {
    for (types::Run& run : recording::ReadRuns(file, map, static_cast<int>(joint))) {
      run.name = file.filename().string();
      out.runs.push_back(std::move(run));
    }
  }
  return out;
}

const fs::path kRobots = fs::path(SINEW_SOURCE_DIR) / "robots";
const fs::path kShared = fs::path(SINEW_SHARED_DIR) / "data";

Set LoadRobot(const std::string& robot, const std::string& folder, const std::string& prefix = "",
              const std::string& map = "csv_map.yaml", std::size_t joint = 0) {
  return Load(kRobots / robot / "model.yaml", kRobots / robot / map,
              CsvFiles(kShared / folder, prefix), joint);
}

Set LoadRig(const fs::path& folder) {
  return Load(folder / "rig.json", kRobots / "rig/csv_map.yaml", CsvFiles(folder));
}

void ExpectNoStop(const Set& set, const std::string& what) {
  ASSERT_FALSE(set.runs.empty()) << what;
  for (const Fault& fault : ExamineData(set.runs, set.model).faults) {
    ADD_FAILURE() << what << ": " << FormatFault(fault) << " statistic " << fault.statistic;
  }
}

void ExpectFound(Set set, const std::string& planted, const std::string& what) {
  Plant(planted, 3, &set.runs, &set.model);
  const GateReport report = ExamineData(set.runs, set.model);
  const auto kind = std::find_if(FaultKinds().begin(), FaultKinds().end(),
                                 [&](const FaultKind& at) { return at.name == planted; });
  ASSERT_NE(kind, FaultKinds().end());
  std::string largest;
  for (const Measurement& at : report.largest) {
    largest += at.rule + " " + at.signal + " " + std::to_string(at.statistic) + "\n";
  }
  EXPECT_TRUE(IsFound(*kind, report)) << what << ", " << planted << ":\n" << largest;
}

#define NEEDS_SHARED(folder)                                                       \
  if (!fs::exists(kShared / (folder))) {                                           \
    GTEST_SKIP() << (kShared / (folder)).string() << " is absent: nothing tested"; \
  }

TEST(GateRecordings, TheRigExamplesPassAndPlantedFaultsAreFound) {
  const fs::path folder = fs::path(SINEW_SOURCE_DIR) / "tests/data/rig_examples";
  const Set clean = LoadRig(folder / "clean"), effect = LoadRig(folder / "one_effect");
  ExpectNoStop(clean, "clean");
  ExpectNoStop(effect, "one_effect");
  bool turn = false;  // each fault in one of them
  for (const FaultKind& kind : FaultKinds()) {
    turn = !turn;
    ExpectFound(turn ? clean : effect, kind.name, turn ? "clean" : "one_effect");
  }
}

TEST(GateRecordings, TheOtherRigPassesLockedPushedAndWithStrongEffects) {
  NEEDS_SHARED("rig_examples_2");
  int folders = 0;
  for (const auto& entry : fs::directory_iterator(kShared / "rig_examples_2")) {
    if (!entry.is_directory()) continue;
    ++folders;
    ExpectNoStop(LoadRig(entry.path()), entry.path().filename().string());
  }
  EXPECT_EQ(folders, 9);
}

TEST(GateRecordings, EmpsPassesAndItsFaultsAreFound) {
  NEEDS_SHARED("emps");
  const Set set = LoadRobot("emps", "emps");
  ExpectNoStop(set, "emps");
  for (const double factor : {-1.0, 1000.0}) {
    Set faulty = set;
    for (types::Run& run : faulty.runs) run.signals[types::Signal::kDriveVoltage] *= factor;
    EXPECT_TRUE(ExamineData(faulty.runs, faulty.model).stops()) << "drive times " << factor;
  }
  Set millimetres = set;
  for (types::Run& run : millimetres.runs) run.signals[types::Signal::kPosition] *= 1000.0;
  EXPECT_TRUE(ExamineData(millimetres.runs, millimetres.model).stops());
  ExpectFound(set, "spike_position", "emps");
  ExpectFound(set, "frozen_position", "emps");
  Set stuck = set;
  Eigen::VectorXd& drive = stuck.runs.front().signals[types::Signal::kDriveVoltage];
  const Eigen::Index rows = drive.size();
  drive.segment(rows / 3, rows / 5).setConstant(drive[rows / 3]);
  const GateReport report = ExamineData(stuck.runs, stuck.model);
  ASSERT_TRUE(report.stops());
  EXPECT_EQ(report.faults.front().rule, "frozen");
  EXPECT_EQ(report.faults.front().signal, "drive_voltage");
}

TEST(GateRecordings, TheServoWithAPendulumPassesAndItsFaultsAreFound) {
  NEEDS_SHARED("bam_xl330_pendulum");
  const Set set = LoadRobot("bam_xl330", "bam_xl330_pendulum");
  ExpectNoStop(set, "bam_xl330");
  for (const auto& [signal, factor] : {std::pair{types::Signal::kDriveVoltage, -1.0},
                                       std::pair{types::Signal::kDriveVoltage, 1000.0},
                                       std::pair{types::Signal::kPosition, 57.29578}}) {
    Set faulty = set;
    for (types::Run& run : faulty.runs) run.signals[signal] *= factor;
    EXPECT_TRUE(ExamineData(faulty.runs, faulty.model).stops())
        << types::SignalName(signal) << " times " << factor;
  }
}

TEST(GateRecordings, ThePneumaticCylindersPass) {
  NEEDS_SHARED("pneumatic_cylinder_3dprinted");
  for (const char* seal : {"O-ring", "NAPN"}) {
    ExpectNoStop(LoadRobot("pneumatic_cylinder", "pneumatic_cylinder_3dprinted", seal), seal);
  }
}

TEST(GateRecordings, TheMotorOnADrivePassesHeldAndSlow) {
  NEEDS_SHARED("odrive_cogging");
  ExpectNoStop(LoadRobot("odrive_motor", "odrive_cogging", "map_"), "held");
  ExpectNoStop(LoadRobot("odrive_motor", "odrive_cogging", "slow_", "csv_map_slow.yaml"), "slow");
}

TEST(GateRecordings, EveryJointOfTheArmPasses) {
  NEEDS_SHARED("kuka_lwr4_inverse_dynamics");
  for (std::size_t joint = 0; joint < 7; ++joint) {
    ExpectNoStop(LoadRobot("kuka_lwr4", "kuka_lwr4_inverse_dynamics", "", "csv_map.yaml", joint),
                 "joint " + std::to_string(joint));
  }
}

// Arms that nothing was chosen on; channels only, their rigid bodies are not declared here.
TEST(GateRecordings, OtherMeasuredArmsPass) {
  NEEDS_SHARED("franka_panda_inverse_dynamics");
  NEEDS_SHARED("schunk_6dof_arm");
  const testing::TemporaryFolder folder;
  for (const auto& [name, joints] :
       {std::pair{"franka_panda_inverse_dynamics", 7}, std::pair{"schunk_6dof_arm", 6}}) {
    const fs::path map =
        folder.Write(std::string(name) + ".yaml",
                     "schema: sinew-csv-map/1\nkind: rotary\njoints: " + std::to_string(joints) +
                         "\ntime: {column: time_s, unit: s}\nsignals:\n"
                         "  position: {column: \"q{joint}_rad\", unit: rad}\n"
                         "  velocity: {column: \"qd{joint}_rad_s\", unit: rad/s}\n"
                         "  torque: {column: \"tau{joint}_Nm\", unit: Nm}\n");
    for (std::size_t joint = 0; joint < static_cast<std::size_t>(joints); ++joint) {
      ExpectNoStop(Load(kRobots / "kuka_lwr4/model.yaml", map, CsvFiles(kShared / name), joint),
                   name + std::string(", joint ") + std::to_string(joint));
    }
  }
}

}  // namespace
}  // namespace sinew::gate
