#include "tools/tune_robot/tune_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "components/robot/control/file/control_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::tune {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path kBipedFiles = SINEW_SOURCE_DIR "/robots/biped";

// The shipped file with its paths made absolute and one text replaced.
std::string Changed(const std::string& name, const std::string& from, const std::string& to) {
  std::string text = config::ReadFile(kBipedFiles / name);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  for (const char* file :
       {" world.yaml", " reference_benchmark.yaml", " performance.yaml", " pneumatics.yaml",
        " world_sea_pea.yaml", " control_pid.yaml", " control_pid_sea_pea.yaml"}) {
    for (std::size_t p = 0; (p = text.find(file, p)) != std::string::npos; p += 8) {
      text.insert(p + 1, kBipedFiles.string() + "/");
    }
  }
  return text;
}

template <class Load>
std::string ErrorOfLoading(const Load& load, const std::string& path) {
  try {
    (void)load(path);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(TuneFile, TheShippedSearchIsOfThePublishedBenchmark) {
  const TuneFile file = LoadTune(kBipedFiles / "tune_pid.yaml");
  EXPECT_EQ(file.trial.control.size(), 12u);
  EXPECT_EQ(file.trial.rate_Hz, 240.0);
  EXPECT_GE(2 * file.search.search.trials, 200);
  ASSERT_FALSE(file.search.compared.empty());
  EXPECT_EQ(file.search.compared[0].name, "published");
  EXPECT_EQ(file.search.compared[0].proportional_Nm_rad, 60.0);
  EXPECT_EQ(file.search.compared[0].integral_Nm_rad_s, 3.5);
  EXPECT_EQ(file.search.compared[0].derivative_Nm_s_rad, 1.0);
  EXPECT_EQ(file.search.rest.derivative_filter_Hz, 20.0);
  EXPECT_EQ(file.inputs.size(), 7u);
}

TEST(TuneFile, TheShippedSweepHasFourPneumaticJoints) {
  const PressureSweepConfig sweep = LoadPressureSweep(kBipedFiles / "tune_pressure.yaml");
  EXPECT_TRUE(PneumaticJoints(sweep.rigid.robot.model).empty());
  EXPECT_EQ(PneumaticJoints(sweep.elastic.robot.model), (std::vector<std::size_t>{3, 4, 9, 10}));
  EXPECT_EQ(sweep.elastic.pneumatics.size(), 12u);
}

TEST(TuneFile, RefusesWhatIsNoSearchWithFileLineAndKey) {
  const sinew::testing::TemporaryFolder folder;
  struct Case {
    const char *from, *to, *expected;
  };
  for (const Case& c :
       {Case{"trials: 120", "trials: 0", "trials"},
        {"seed: 1", "sed: 1", "sed"},
        {"[20, 1000]", "[1000, 20]", "proportional_Nm_rad"},
        {"[20, 1000]", "[0, 20]", "proportional_Nm_rad"},
        {"most_tilt_rad: 0.524", "most_tilt_rad: 30", "most_tilt_rad"},
        {"world: world.yaml", "world: world_stand.yaml", "world_stand.yaml"},
        {"control: control_pid.yaml",
         "control: " SINEW_SOURCE_DIR "/robots/biped/control_computed_torque.yaml",
         "needs a torque prediction"},
        {"control: control_pid.yaml",
         "control: " SINEW_SOURCE_DIR "/robots/biped/control_position.yaml", "without PID"},
        {"control: control_pid.yaml", "control: " SINEW_SOURCE_DIR "/robots/rig/control_pid.yaml",
         "has 1 joints, expected the model's 12"},
        {"world: world.yaml", "world: " SINEW_SOURCE_DIR "/robots/biped/world_stand.yaml",
         "fixed base"}}) {
    const std::string path = folder.Write("search.yaml", Changed("tune_pid.yaml", c.from, c.to));
    const std::string error = ErrorOfLoading(LoadTune, path);
    EXPECT_THAT(error, StartsWith(path + ":")) << c.to;
    EXPECT_THAT(error, HasSubstr(c.expected)) << c.to;
  }
  const std::string sweep =
      folder.Write("sweep.yaml", Changed("tune_pressure.yaml", "pneumatics: ", "pneumatic: "));
  EXPECT_THAT(ErrorOfLoading(LoadPressureSweep, sweep), HasSubstr("pneumatic"));
}

TEST(TuneFile, WritesAControllerThatReadsBackWithTheGains) {
  const sinew::testing::TemporaryFolder folder;
  const control::PidConfig pid{
      .proportional_Nm_rad = 612.3, .integral_Nm_rad_s = 0.7346, .derivative_Nm_s_rad = 12.0};
  const std::string text =
      ControlText(kBipedFiles / "control_pid.yaml", pid, folder.path(), "Found.\nTwo lines.");
  EXPECT_THAT(text, StartsWith("# Found.\n# Two lines.\nschema: sinew-control/1\n"));
  const control::ControlConfig read = control::LoadControl(folder.Write("control.yaml", text));
  ASSERT_EQ(read.joints.size(), 12u);
  for (const control::JointControlConfig& joint : read.joints) {
    EXPECT_EQ(joint.pid.proportional_Nm_rad, 612.3);
    EXPECT_EQ(joint.pid.integral_Nm_rad_s, 0.7346);
    EXPECT_EQ(joint.pid.derivative_Nm_s_rad, 12.0);
    EXPECT_EQ(joint.pid.derivative_filter_Hz, 20.0);
  }
  EXPECT_EQ(read.joints[3].gear_ratio, 100.0) << "the model's path is kept";
  EXPECT_THROW(
      (void)ControlText(kBipedFiles / "control_position.yaml", pid, folder.path(), "Found."),
      UsageError);
}

}  // namespace
}  // namespace sinew::tune
