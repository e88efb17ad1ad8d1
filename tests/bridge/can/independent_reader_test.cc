// An independent reader decodes our bytes: Debian's python3-canmatrix with the DBC file of each
// protocol. Skipped where it is not installed, or where ODrive's file is not at hand.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bridge/can/body_node.h"
#include "bridge/can/codec.h"
#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"
#include "tests/support/program.h"
#include "tests/support/skip.h"

namespace sinew::can {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // where Debian's packages are
const std::string kOurs = std::string(SINEW_SOURCE_DIR) + "/bridge/can/sinew_nodes.dbc";
const std::string kODrive =
    std::string(SINEW_SHARED_DIR) + "/data/odrive_cansimple_dbc/odrive-cansimple.dbc";

std::string Text(const Frame& frame) {
  char text[8];
  std::snprintf(text, sizeof text, "%03X#", frame.id);
  std::string result = text;
  for (std::size_t i = 0; i < frame.length; ++i) {
    std::snprintf(text, sizeof text, "%02X", frame.data[i]);
    result += text;
  }
  return result;
}

using Signals = std::map<std::string, double>;

class IndependentReader : public ::testing::Test {
 protected:
  void SetUp() override {
    SKIP_WITHOUT_PACKAGE(
        std::filesystem::exists(kPython) &&
            testing::Run({kPython, "-c", "import canmatrix.formats"}).exit_code == 0,
        "python3-canmatrix");
  }
  // What the reader makes of the frames: message name and its signals, in order.
  static std::vector<std::pair<std::string, Signals>> Read(const std::string& dbc,
                                                           const std::vector<Frame>& frames) {
    std::vector<std::string> arguments = {
        kPython, std::string(SINEW_SOURCE_DIR) + "/tests/bridge/can/decode_frames.py", dbc};
    for (const Frame& frame : frames) arguments.push_back(Text(frame));
    const testing::Finished run = testing::Run(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.error;
    std::vector<std::pair<std::string, Signals>> messages;
    std::istringstream lines(run.output);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string name, word;
      words >> name;
      Signals signals;
      while (words >> word) {
        const std::size_t equals = word.find('=');
        signals[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
      }
      messages.emplace_back(name, signals);
    }
    return messages;
  }
  static void Expect(const std::pair<std::string, Signals>& message, const std::string& name,
                     const Signals& expected, double tolerance) {
    EXPECT_EQ(message.first, name);
    for (const auto& [signal, value] : expected) {
      ASSERT_EQ(message.second.count(signal), 1U) << name << "." << signal;
      EXPECT_NEAR(message.second.at(signal), value, tolerance) << name << "." << signal;
    }
  }
};

constexpr double kFloat = 1e-5;  // float32 of values up to 100

TEST_F(IndependentReader, ReadsOurControllerFramesWithODrivesOwnFile) {
  SKIP_WITHOUT_DATA(kODrive);
  const std::vector<Frame> frames = {
      Encode(3, Heartbeat{0x800, AxisState::kIdle, true, false, false, false}),
      Encode(0, EncoderEstimates{-12.5, 3.25}),
      Encode(7, SetInputPos{1.5, -0.75, 0.125}),
      Encode(1, SetInputVel{2.0, 0.25}),
      Encode(1, SetInputTorque{-0.0375}),
      Encode(2, SetAxisState{AxisState::kClosedLoopControl}),
      Encode(2, SetControllerMode{ControlMode::kVelocity, InputMode::kTrapTraj}),
      Encode(2, SetLimits{60.0, 20.0}),
      Encode(4, Iq{1.25, 1.5}),
      Encode(4, BusVoltageCurrent{23.9, 0.5}),
      Encode(5, EncoderCount{100000, 512}),
      Encode(5, SetVelGains{0.16, 0.32}),
      Encode(5, SetLinearCount{-7}),
      Encode(6, ControllerError{0x80}),
      Encode(6, MotorError{0x1000}),
  };
  const auto messages = Read(kODrive, frames);
  ASSERT_EQ(messages.size(), frames.size());
  std::size_t i = 0;
  Expect(messages[i++], "Axis3_Heartbeat",
         {{"Axis_Error", 0x800},
          {"Axis_State", 1},
          {"Motor_Error_Flag", 1},
          {"Encoder_Error_Flag", 0},
          {"Controller_Error_Flag", 0},
          {"Trajectory_Done_Flag", 0}},
         0);
  Expect(messages[i++], "Axis0_Get_Encoder_Estimates",
         {{"Pos_Estimate", -12.5}, {"Vel_Estimate", 3.25}}, kFloat);
  Expect(messages[i++], "Axis7_Set_Input_Pos",
         {{"Input_Pos", 1.5}, {"Vel_FF", -0.75}, {"Torque_FF", 0.125}}, kFloat);
  Expect(messages[i++], "Axis1_Set_Input_Vel", {{"Input_Vel", 2.0}, {"Input_Torque_FF", 0.25}},
         kFloat);
  Expect(messages[i++], "Axis1_Set_Input_Torque", {{"Input_Torque", -0.0375}}, kFloat);
  Expect(messages[i++], "Axis2_Set_Axis_State", {{"Axis_Requested_State", 8}}, 0);
  Expect(messages[i++], "Axis2_Set_Controller_Mode", {{"Control_Mode", 2}, {"Input_Mode", 5}}, 0);
  Expect(messages[i++], "Axis2_Set_Limits", {{"Velocity_Limit", 60.0}, {"Current_Limit", 20.0}},
         kFloat);
  Expect(messages[i++], "Axis4_Get_Iq", {{"Iq_Setpoint", 1.25}, {"Iq_Measured", 1.5}}, kFloat);
  Expect(messages[i++], "Axis4_Get_Bus_Voltage_Current",
         {{"Bus_Voltage", 23.9}, {"Bus_Current", 0.5}}, kFloat);
  Expect(messages[i++], "Axis5_Get_Encoder_Count",
         {{"Shadow_Count", 100000}, {"Count_in_CPR", 512}}, 0);
  Expect(messages[i++], "Axis5_Set_Vel_Gains", {{"Vel_Gain", 0.16}, {"Vel_Integrator_Gain", 0.32}},
         kFloat);
  Expect(messages[i++], "Axis5_Set_Linear_Count", {{"Position", -7}}, 0);
  Expect(messages[i++], "Axis6_Get_Controller_Error", {{"Controller_Error", 0x80}}, 0);
  Expect(messages[i++], "Axis6_Get_Motor_Error", {{"Motor_Error", 0x1000}}, 0);
}

TEST_F(IndependentReader, ReadsOurOwnFramesWithOurFile) {
  CompactReferences references;
  CompactState state;
  for (std::size_t k = 0; k < 12; ++k) {
    references.position_turns[k] = 0.5 * static_cast<double>(k);
    state.position_turns[k] = -1.25 * static_cast<double>(k);
    state.velocity_turns_s[k] = 3.5 * static_cast<double>(k);
    state.iq_A[k] = 0.25 * static_cast<double>(k);
  }
  state.force_N[5] = 123.4;
  state.acceleration_m_s2[2] = 9.81;
  state.angular_velocity_rad_s[0] = -1.234;
  state.roll_pitch_yaw_rad[2] = 3.0001;
  state.sequence = 77;
  std::vector<Frame> frames = {
      Encode(32, NodeHeartbeat{123456, node_error::kLoadCell, 1}),
      Encode(32, OutputEncoder{-0.654321, 1.234, 250, true, false, true, false, true, false, true}),
      Encode(32, JointSensors{4.567, -0.012, -98.76, 45.6}),
      Encode(32, ValveCommand{true, false, true, 9, 60}),
  };
  const auto reference_frames = EncodeReferences(48, references);
  const auto state_frames = EncodeState(48, state);
  frames.insert(frames.end(), reference_frames.begin(), reference_frames.end());
  frames.insert(frames.end(), state_frames.begin(), state_frames.end());

  const auto messages = Read(kOurs, frames);
  ASSERT_EQ(messages.size(), frames.size());
  Expect(messages[0], "Node_Heartbeat",
         {{"Uptime", 123456}, {"Node_Error", 4}, {"Frames_Version", 1}}, 0);
  Expect(messages[1], "Output_Encoder",
         {{"Angle", -0.654321},
          {"Velocity", 1.234},
          {"Sequence", 250},
          {"Encoder_Valid", 1},
          {"Pressure_Valid", 0},
          {"Load_Valid", 1},
          {"Valve_Open", 0},
          {"Compressor_On", 1},
          {"Vent_Open", 0},
          {"Watchdog_Expired", 1}},
         1e-9);
  Expect(messages[2], "Joint_Sensors",
         {{"Chamber_Pressure", 4.567},
          {"Reservoir_Pressure", -0.012},
          {"Load_Force", -98.76},
          {"Motor_Temperature", 45.6}},
         1e-9);
  Expect(messages[3], "Valve_Command",
         {{"Set_Valve_Open", 1},
          {"Set_Compressor_On", 0},
          {"Set_Vent_Open", 1},
          {"Command_Sequence", 9},
          {"Command_Timeout", 60}},
         0);
  Signals all;
  for (std::size_t i = 4; i < messages.size(); ++i)
    all.insert(messages[i].second.begin(), messages[i].second.end());
  for (int k = 0; k < 12; ++k) {
    EXPECT_NEAR(all.at("Reference_" + std::to_string(k)), 0.5 * k, 1e-9);
    EXPECT_NEAR(all.at("Position_" + std::to_string(k)), -1.25 * k, 1e-9);
    EXPECT_NEAR(all.at("Velocity_" + std::to_string(k)), 3.5 * k, 1e-9);
    EXPECT_NEAR(all.at("Iq_" + std::to_string(k)), 0.25 * k, 1e-9);
  }
  EXPECT_NEAR(all.at("Force_5"), 123.4, 1e-9);
  EXPECT_NEAR(all.at("Acceleration_z"), 9.81, 1e-9);
  EXPECT_NEAR(all.at("Angular_Velocity_x"), -1.234, 1e-9);
  EXPECT_NEAR(all.at("Yaw"), 3.0001, 1e-9);
  EXPECT_EQ(all.at("State_Sequence"), 77);
}

TEST_F(IndependentReader, ReadsTheFramesOfBodyNodesWithOurFile) {
  const std::vector<Frame> frames = {
      Encode(40, NodeHeartbeat{98765, node_error::kFootForce}),
      Encode(40, FootForces{{123.4, -0.6, 819.0, -819.2}, {true, false, true, false}, 251}),
      Encode(42, NodeHeartbeat{98765, node_error::kOrientation}),
      Encode(42, ImuForce{{-163.84, 0.005, 9.81}, 252, true, false, true}),
      Encode(42, ImuRate{{-32.768, 17.453, 0.001}, 253, -40}),
      Encode(42, ImuOrientation{{-0.7040, 0.000022, 0.5}, 254, 3}),
      Encode(42, ImuRate{}),
  };
  const auto messages = Read(kOurs, frames);
  ASSERT_EQ(messages.size(), frames.size());
  Expect(messages[0], "Foot_Heartbeat",
         {{"Uptime", 98765}, {"Node_Error", 16}, {"Frames_Version", 1}}, 0);
  Expect(messages[1], "Foot_Forces",
         {{"Foot_Force_0", 123.4},
          {"Foot_Force_1", -0.6},
          {"Foot_Force_2", 819.0},
          {"Foot_Force_3", -819.2},
          {"Foot_Sequence", 251},
          {"Foot_Valid_0", 1},
          {"Foot_Valid_1", 0},
          {"Foot_Valid_2", 1},
          {"Foot_Valid_3", 0}},
         1e-9);
  Expect(messages[2], "Imu_Heartbeat",
         {{"Uptime", 98765}, {"Node_Error", 64}, {"Frames_Version", 1}}, 0);
  Expect(messages[3], "Imu_Force",
         {{"Specific_Force_x", -163.84},
          {"Specific_Force_y", 0.005},
          {"Specific_Force_z", 9.81},
          {"Force_Sequence", 252},
          {"Force_Valid", 1},
          {"Rate_Valid", 0},
          {"Orientation_Valid", 1}},
         1e-9);
  Expect(messages[4], "Imu_Rate",
         {{"Rate_x", -32.768},
          {"Rate_y", 17.453},
          {"Rate_z", 0.001},
          {"Rate_Sequence", 253},
          {"Imu_Temperature", -40}},
         1e-9);
  // Steps of 2.2e-5: what was asked for within half of one.
  Expect(messages[5], "Imu_Orientation",
         {{"Component_0", -0.7040},
          {"Component_1", 0.000022},
          {"Component_2", 0.5},
          {"Orientation_Sequence", 254},
          {"Omitted", 3}},
         1.1e-5);
  Expect(messages[6], "Imu_Rate", {{"Imu_Temperature", -128}}, 0);
}

}  // namespace
}  // namespace sinew::can
