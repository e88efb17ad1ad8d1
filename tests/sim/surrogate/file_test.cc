#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "components/base/types/control_mode.h"
#include "sim/surrogate/file/rows_csv.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/rig.h"

namespace sinew::surrogate {
namespace {

std::string ErrorOf(const std::string& yaml) {
  try {
    const config::Section section = config::Section::Parse("schema: sinew-surrogate/1\n" + yaml,
                                                           "test.yaml", "sinew-surrogate/1");
    ReadRig(section);
    section.RejectUnknownKeys();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

// Runs both for a moment: every parameter has a part in it.
void ExpectSame(const RigParameters& a, const RigParameters& b) {
  Rig first{a}, second{b};
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 0.03};
  input.compressor_on = input.vent_open = true;
  for (int i = 0; i < 240; ++i) {
    input.valve_open = i > 120;
    input.drive.mode = i > 180 ? types::ControlMode::kPosition : types::ControlMode::kTorque;
    first.Advance(input, 1.0 / 240.0);
    second.Advance(input, 1.0 / 240.0);
    const RigReading x = first.Read(), y = second.Read();
    ASSERT_EQ(x.motor_angle_rad, y.motor_angle_rad);
    ASSERT_EQ(x.output_velocity_rad_s, y.output_velocity_rad_s);
    ASSERT_EQ(x.motor_current_A, y.motor_current_A);
    ASSERT_EQ(x.chamber_pressure_bar, y.chamber_pressure_bar);
    ASSERT_EQ(x.motor_temperature_degC, y.motor_temperature_degC);
    ASSERT_EQ(first.truth().chamber_pressure_bar, second.truth().chamber_pressure_bar);
  }
}

TEST(SurrogateFile, TheRigsFileSaysTheDefaults) {
  ExpectSame(LoadRig(std::string(SINEW_SOURCE_DIR) + "/robots/rig/surrogate.yaml"),
             RigParameters{});
}

TEST(SurrogateFile, TheOtherRigsElementPullsToAnAngle) {
  const RigParameters rig =
      LoadRig(std::string(SINEW_SOURCE_DIR) + "/robots/rig/surrogate_spring.yaml");
  const PneumaticLine line = LinePneumatics(rig);
  EXPECT_NEAR(line.slope_Nm_bar, 0.3587 + 4.0 * 0.16, 1e-3);
  EXPECT_NEAR(line.stiffness_Nm_rad_bar, 4.0, 1e-3);
  const PneumaticLine vane = LinePneumatics(RigParameters{});
  EXPECT_NEAR(vane.slope_Nm_bar, 0.3587, 1e-3);
  EXPECT_NEAR(vane.stiffness_Nm_rad_bar, 0.006, 0.002);
}

TEST(SurrogateFile, NoFileIsTheRig) { ExpectSame(LoadRig(""), RigParameters{}); }

TEST(SurrogateFile, AValueOfTheFileArrives) {
  const config::Section section = config::Section::Parse(
      "schema: sinew-surrogate/1\neffects: [cogging=0.001, payload@5]\nlink: {gravity_torque_Nm: "
      "0.7}\n",
      "test.yaml", "sinew-surrogate/1");
  const RigParameters rig = ReadRig(section);
  EXPECT_EQ(rig.link.gravity_torque_Nm, 0.7);
  ASSERT_EQ(rig.effects.size(), 2u);
  EXPECT_EQ(rig.effects[0].size, 0.001);
  EXPECT_EQ(rig.effects[1].from_s, 5.0);
}

TEST(SurrogateFile, BadInputIsReportedInOneLineWithFileLineAndKey) {
  EXPECT_NE(ErrorOf("links: {}\n").find("test.yaml:2: key 'links'"), std::string::npos);
  EXPECT_NE(ErrorOf("link: {inertia_g_m2: 19}\n").find("link.inertia_kg_m2"), std::string::npos);
  EXPECT_NE(ErrorOf("gear: {play_rad: .nan}\n").find("gear.play_rad"), std::string::npos);
  EXPECT_NE(ErrorOf("gear: {play_rad: wide}\n").find("gear.play_rad"), std::string::npos);
  EXPECT_NE(ErrorOf("effects: [wobble]\n").find("wobble"), std::string::npos);
  EXPECT_NE(ErrorOf("initial_angle_rad: 3\n").find("end stop"), std::string::npos);
  EXPECT_NE(ErrorOf("gear: {contact_stiffness_Nm_rad: 1.0e9}\n").find("too stiff"),
            std::string::npos);
  for (const std::string yaml : {"links: {}\n", "effects: [wobble]\n", "initial_angle_rad: 3\n"}) {
    EXPECT_EQ(ErrorOf(yaml).find('\n'), std::string::npos);
  }
}

TEST(SurrogateFile, EffectsOfTheCommandLineAreParsedOrRefused) {
  EXPECT_TRUE(ParseEffects({"none"}).empty());
  EXPECT_EQ(ParseEffects({"stribeck=0.1", "cogging"}).size(), 2u);
  EXPECT_THROW(ParseEffects({"stribeck=a lot"}), UsageError);
}

TEST(SurrogateFile, EveryEffectIsDescribedInALine) {
  std::istringstream lines(DescribeEffects());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "none");
  for (const EffectInfo& info : UndeclaredEffects()) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line.rfind(std::string(info.name) + " (default ", 0), 0u) << line;
  }
}

TEST(RowsCsv, HasTheLabsColumnsAndCountsToTheDigit) {
  LogRow row;
  row.time_s = 0.01234;
  row.motor_angle_rad = 5.675345;
  row.valve_open = true;
  row.motor_temperature_degC = 23.0;
  EXPECT_EQ(RowsToCsv({row}),
            "time_s,motor_angle_rad,motor_velocity_rad_s,output_angle_rad,output_velocity_rad_s,"
            "motor_current_A,chamber_pressure_bar,load_force_N,valve_open,payload_kg,motor_"
            "temperature_degC\n"
            "0.01234,5.675345,0.0000,0.000000,0.00000,0.0000,0.00000,0.0000,1,0.000,23.0\n");
}

}  // namespace
}  // namespace sinew::surrogate
