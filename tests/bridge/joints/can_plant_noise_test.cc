// Foreign, broken and forged frames: none moves a joint or a setpoint beyond its limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

// Whatever comes over the bus, forged answers of our own axes included: no setpoint beyond the
// limits, none that is not finite, none to a joint that is not commanded to move.
// SINEW_FUZZ_FRAMES=100000000 makes a long run of it.
TEST(CanPlant, FuzzedFramesNeverMakeASetpointBeyondTheLimitsNorToAnotherJoint) {
  const char* text = std::getenv("SINEW_FUZZ_FRAMES");
  const long frames = text == nullptr ? 300'000 : std::atol(text);
  const Bench bench({.joints = 3});
  Deaf bus;
  for (int node = 1; node <= 3; ++node) {
    bus.frames.push_back(can::Encode(node, can::Heartbeat{0, can::AxisState::kClosedLoopControl}));
    bus.frames.push_back(can::Encode(node, can::EncoderEstimates{}));
    bus.frames.push_back(can::Encode(node + 32, can::OutputEncoder{0.25, 0, 0, true}));
    bus.frames.push_back(can::Encode(node + 32, can::JointSensors{}));
  }
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  const double most_Nm = 0.398 * (8.27 / 600) / test::Rotors::kTorqueConstant_Nm_A * (1.0 + 1e-6);
  long moved = 0, wrong = 0;
  bus.on_send = [&](const can::Frame& frame) {
    const int node = can::AddressOf(frame)->node;
    if (node < 1 || (node > 3 && node < 33) || node > 35) ++wrong;
    if (const auto t = can::Decode<can::SetInputTorque>(frame)) {
      if (!(std::abs(t->torque_Nm) <= most_Nm)) ++wrong;
      if (t->torque_Nm != 0.0) {
        ++moved;
        if (node != 2) ++wrong;  // only the second joint is commanded to move
      }
    }
    if (const auto p = can::Decode<can::SetInputPos>(frame); p && node != 2) ++wrong;
  };
  std::mt19937 random(29);
  provider::PlantCommand command;
  const std::vector<can::Frame> good = bus.frames;
  std::uint8_t sequence = 0;
  for (long sent = 0; sent < frames;) {
    bus.frames = good;  // the axes are alive, so that there is something to move
    ++sequence;
    for (can::Frame& frame : bus.frames) {
      if (can::DecodeOutputEncoder(frame) && can::AddressOf(frame)->node > 32)
        frame.data[6] = sequence;
    }
    for (int i = 0; i < 30; ++i, ++sent) {
      can::Frame frame;
      const bool ours = random() % 2 == 0;
      frame.id = ours ? ((random() % 3 + (random() % 2 == 0 ? 1 : 33)) << 5 | random() % 32)
                      : random() & 0x7FF;
      frame.remote = random() % 16 == 0;
      frame.extended = random() % 16 == 0;
      frame.error = random() % 16 == 0;
      frame.length = static_cast<std::uint8_t>(random() % 10);
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
      bus.frames.push_back(frame);
    }
    std::shuffle(bus.frames.begin(), bus.frames.end(), random);
    bus.next = 0;
    bus.now += kPeriod_ns;
    command.mode[1] = random() % 8 == 0 ? ControlMode::kPosition : ControlMode::kTorque;
    command.motor_torque_Nm[1] =
        1e-3 * static_cast<double>(static_cast<int>(random() % 2001) - 1000);
    command.position_rad[1] = 1e-3 * static_cast<double>(static_cast<int>(random() % 4001) - 2000);
    plant.Step(command, kPeriod_s, &sensors);
    if (sent % 3000 < 30) plant.ClearFault();  // the operator who never gives up
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(moved, 0) << "the test must reach the setpoints";
  EXPECT_GT(plant.malformed(), 0U);
}

TEST(CanPlant, NoiseOfForeignAndBrokenFramesMovesNoJointAndIsNoFault) {
  Bench bench;
  bench.Start();
  bench.Arm();
  const auto noise = bench.buses[0]->Join("noise");
  std::mt19937 random(23);
  for (int cycle = 0; cycle < 1000; ++cycle) {
    for (int i = 0; i < 5; ++i) {
      can::Frame frame;
      frame.extended = random() % 4 == 0;
      frame.id = random() & (frame.extended ? can::kMaxExtendedId : can::kMaxStandardId);
      // Not with identifiers of our nodes: those frames are forged, not noise.
      if (!frame.extended && (frame.id >> 5 == 1 || frame.id >> 5 == 33)) continue;
      frame.length = static_cast<std::uint8_t>(random() % 9);
      for (std::size_t k = 0; k < frame.length; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random());
      (void)noise->Send(frame);
    }
    bench.Step();
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.rotors.angle_rad[0], 0.0);
}

TEST(CanPlant, TruncatedAndNonFiniteAnswersAreCountedAndRejected) {
  Bench bench;
  bench.Start();
  bench.Steps(5);
  const auto forger = bench.buses[0]->Join("forger");
  can::Frame cut = can::Encode(1, can::EncoderEstimates{50.0, 0.0});
  cut.length = 7;
  cut.data[7] = 0;
  ASSERT_EQ(forger->Send(cut), can::SendStatus::kOk);
  ASSERT_EQ(forger->Send(can::Encode(1, can::EncoderEstimates{std::nan(""), 0.0})),
            can::SendStatus::kOk);
  bench.Steps(2);
  EXPECT_EQ(bench.plant->malformed(), 2U);
  EXPECT_NEAR(bench.sensors.motor_position_rad[0], 0.0, 1e-9);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

}  // namespace
}  // namespace sinew::bridge
