#include "components/robot/control/file/control_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace sinew::control {
namespace {

using ::testing::HasSubstr;

const std::string kRig = std::string(SINEW_SOURCE_DIR) + "/robots/rig/model.yaml";
const std::string kEmps = std::string(SINEW_SOURCE_DIR) + "/robots/emps/model.yaml";

ControlConfig Parse(const std::string& text) {
  return config::Read<ControlConfig>(config::Section::Parse("schema: sinew-control/1\n" + text,
                                                            "control.yaml", "sinew-control/1"));
}

std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(Parse(text));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ControlFile, ReadsAPidWithItsOwnDrive) {
  const ControlConfig config = Parse(R"(motion_requests: every_tick
joints:
  - strategy: pid
    drive: {gear_ratio: 100, efficiency: 0.77, motor_torque_limit_Nm: 0.398}
    pid: {proportional_Nm_rad: 12, integral_Nm_rad_s: 10, derivative_Nm_s_rad: 1, derivative_filter_Hz: 40}
    velocity_from: motor
)");
  ASSERT_EQ(config.joints.size(), 1u);
  EXPECT_EQ(config.joints[0].pid.integral_Nm_rad_s, 10.0);
  EXPECT_NEAR(config.joints[0].shaft_per_output, 1.0 / 77.0, 1e-15);
  EXPECT_EQ(config.joints[0].velocity_from, VelocityFrom::kMotor);
  EXPECT_EQ(config.motion_requests, MotionRequests::kEveryTick);
  EXPECT_EQ(config.joints[0].tracking_error_limit_rad, kTrackingErrorLimit_rad);
  EXPECT_EQ(config.joints[0].replay_takeover_s, 2.0);
  EXPECT_FALSE(config.needs_prediction());
}

TEST(ControlFile, ReadsTheRigsModelForFeedForward) {
  const ControlConfig config = Parse("joints:\n  - strategy: pid_linear\n    model: " + kRig +
                                     "\n    compensate: linear\n    motor_torque_limit_Nm: 0.3\n"
                                     "    pid: {proportional_Nm_rad: 12}\n");
  EXPECT_EQ(config.joints[0].compensator.kind, CompensatorKind::kLinear);
  EXPECT_EQ(config.joints[0].motor_torque_limit_Nm, 0.3);
  EXPECT_EQ(config.joints[0].gear_ratio, 100.0);
}

TEST(ControlFile, ReadsATorqueOverTimeAndNamesTheRowThatIsWrong) {
  const std::string path = ::testing::TempDir() + "recorded_torque.csv";
  const auto write = [&path](const std::string& text) { std::ofstream(path) << text; };
  const std::string yaml = "joints:\n  - strategy: pid_linear\n    model: " + kRig +
                           "\n    compensate: recorded\n    recorded_torque: " + path +
                           "\n    pid: {proportional_Nm_rad: 12}\n";
  write("time_s,motor_torque_Nm\n0,0.01\n0.0041667,-0.02\n0.0083333,0.03\n");
  const RecordedTorque recorded = Parse(yaml).joints[0].compensator.recorded;
  EXPECT_NEAR(recorded.period_s, 1.0 / 240.0, 1e-7);
  EXPECT_EQ(recorded.motor_torque_Nm, (std::vector<double>{0.01, -0.02, 0.03}));
  write("time_s,torque\n0,0.01\n");
  EXPECT_THAT(ErrorOf(yaml), HasSubstr("recorded_torque.csv:1: 'time_s,torque', expected"));
  write("time_s,motor_torque_Nm\n0,0.01\n0.004;0.02\n");
  EXPECT_THAT(ErrorOf(yaml), HasSubstr("recorded_torque.csv:3: '0.004;0.02', expected"));
  write("time_s,motor_torque_Nm\n0,0.01\n0.004,0.02\n0.012,0.02\n");
  EXPECT_THAT(ErrorOf(yaml), HasSubstr("expected rows at one period"));
  write("time_s,motor_torque_Nm\n0,0.01\n");
  EXPECT_THAT(ErrorOf(yaml), HasSubstr("expected two rows"));
}

TEST(ControlFile, AnotherModelMayTakeThePlaceOfTheNamedOne) {
  const ControlConfig config = config::Read<ControlConfig>(
      config::Section::Parse("schema: sinew-control/1\njoints: [{strategy: pid_linear, model: " +
                                 kRig + ", force_limit_N: 350, pid: {proportional_N_m: 1000}}]\n",
                             "control.yaml", "sinew-control/1"),
      kEmps);
  EXPECT_EQ(config.joints[0].model->kind, types::JointKind::kPrismatic);
}

TEST(ControlFile, APrismaticAxisCarriesNewtonsAndMetres) {
  const std::string head =
      "joints:\n  - strategy: pid_linear\n    model: " + kEmps + "\n    force_limit_N: 350\n";
  const ControlConfig config = Parse(
      head + "    pid: {proportional_N_m: 60000, integral_N_m_s: 1000, derivative_N_s_m: 3000}\n");
  EXPECT_EQ(config.joints[0].pid.proportional_Nm_rad, 60000.0);
  EXPECT_NEAR(config.joints[0].shaft_per_output, 1.0, 1e-9);
  EXPECT_EQ(config.joints[0].tracking_error_limit_rad, kTrackingErrorLimit_m);
  EXPECT_THAT(ErrorOf(head + "    pid: {proportional_Nm_rad: 60000}\n"),
              HasSubstr("proportional_N_m"));
}

TEST(ControlFile, NetworksNeedPredictions) {
  EXPECT_TRUE(
      Parse("joints: [{strategy: pid_esn, model: " + kRig + ", pid: {proportional_Nm_rad: 12}}]\n")
          .needs_prediction());
}

TEST(ControlFile, ComputedTorqueNeedsPredictionsAndNoRegime) {
  const ControlConfig config = Parse(
      "joints: [{strategy: computed_torque, drive: {gear_ratio: 100, "
      "motor_torque_limit_Nm: 0.4}, pid: {proportional_Nm_rad: 25, derivative_Nm_s_rad: 0.1}}]\n");
  EXPECT_EQ(config.joints[0].strategy, Strategy::kComputedTorque);
  EXPECT_TRUE(config.needs_prediction());
  EXPECT_FALSE(config.needs_regime());
}

TEST(ControlFile, ReportsAnErrorInOneLine) {
  const std::string drive = "drive: {gear_ratio: 100, motor_torque_limit_Nm: 0.4}";
  const struct {
    std::string text;
    const char* says;
  } kCases[] = {
      {"joints: []\n", "expected 1 to 12"},
      {"joint_names: [left, right]\njoints:\n  - {strategy: position}\n",
       "'joint_names': has 2 entries, expected as many as joints, 1"},
      {"joints: [{strategy: magic}]\n", "strategy"},
      {"joints: [{strategy: pid, " + drive + "}]\n", "pid"},
      {"joints: [{strategy: pid, pid: {proportional_Nm_rad: 1}}]\n", "drive"},
      {"joints: [{strategy: pid, " + drive + ", pid: {proportional_Nm_rad: -1}}]\n",
       "proportional_Nm_rad"},
      {"joints: [{strategy: pid, " + drive + ", pid: {proportional_Nm_deg: 1}}]\n",
       "proportional_Nm_rad"},
      {"joints: [{strategy: pid, " + drive + ", pid: {proportional_Nm_rad: .inf}}]\n",
       "at least 0"},
      {"joints: [{strategy: pid, drive: {gear_ratio: 100}, pid: {proportional_Nm_rad: 1}}]\n",
       "motor_torque_limit_Nm"},
      {"joints: [{strategy: pid_linear, " + drive + ", pid: {proportional_Nm_rad: 1}}]\n",
       "model file"},
      {"joints: [{strategy: pid, model: " + kRig + ", " + drive +
           ", pid: {proportional_Nm_rad: 1}}]\n",
       "only one"},
      {"joints: [{strategy: pid, model: absent.yaml, pid: {proportional_Nm_rad: 1}}]\n",
       "absent.yaml"},
      {"joints: [{strategy: pid, model: " + kRig +
           ", model_joint: knee, pid: {proportional_Nm_rad: 1}}]\n",
       "knee"},
      {"joints: [{strategy: pid, model: " + kRig +
           ", motor_torque_limit_Nm: 9, pid: {proportional_Nm_rad: 1}}]\n",
       "above the drive's own limit"},
      {"joints: [{strategy: pid, " + drive +
           ", pid: {proportional_Nm_rad: 1}, smoothing_rad_s: 1}]\n",
       "smoothing_rad_s"},
      {"joints: [{strategy: computed_torque, " + drive +
           ", pid: {proportional_Nm_rad: 1, integral_Nm_rad_s: 1}}]\n",
       "integral gain"},
      {"motion_requests: maybe\njoints: [{strategy: position}]\n", "motion_requests"},
  };
  for (const auto& c : kCases) {
    const std::string error = ErrorOf(c.text);
    EXPECT_THAT(error, HasSubstr(c.says)) << c.text;
    EXPECT_THAT(error, HasSubstr("control.yaml:")) << c.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace sinew::control
