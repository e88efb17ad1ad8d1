// The biped of robots/biped behind CAN in one process and in simulated time: the files can_bridge
// and virtual_axes as they are, but for the buses, which are in memory; the provider's decisions of
// each cycle; the squat's reference as the commands of the drives' position loops.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bridge/joints/file/bridge_config.h"
#include "bridge/virtual_axes/file/virtual_axes_config.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/world/file/world_file.h"
#include "tests/support/memory_can.h"

namespace sinew {

inline const std::string kBipedFiles = SINEW_SOURCE_DIR "/robots/biped/";

// What the frames lose is measured against the world's truth, so the world's own sensors are ideal.
inline world::WorldFile WithoutSensorErrors(world::WorldFile file) {
  file.floating_base->imu_errors = {};
  file.floating_base->foot_errors = {};
  return file;
}

class CanBiped {
 public:
  static constexpr std::size_t kJoints = 12;

  explicit CanBiped(double rate_Hz = 240.0)
      : period_ns_(std::llround(1e9 / rate_Hz)),
        axes_file_(config::Read<virtual_axes::VirtualAxesFile>(
            config::Section::Load(kBipedFiles + "virtual_axes.yaml", "sinew-virtual-axes/1"))),
        robot_(world::MakeWorld(WithoutSensorErrors(world::LoadWorldFile(axes_file_.world_path)),
                                "world.yaml")),
        reference_(reference::LoadReference(kBipedFiles + "reference_benchmark.yaml")) {
    const auto map = config::Section::Load(kBipedFiles + "can_bridge.yaml", "sinew-can-bridge/1");
    bridge_ = config::Read<bridge::BridgeFile>(map);
    provider::CycleConfig config;
    config.guard = provider::LoadGuardConfig(map.ChildOrEmpty("guard"));
    map.RejectUnknownKeys();
    config.session_id = kSession;
    config.joint_count = kJoints;
    config.rate_Hz = rate_Hz;
    config.simulated_time = true;
    cycle_ = std::make_unique<provider::ProviderCycle>(config);
    std::vector<can::Transport*> bridge_ends, axes_ends;
    for (std::size_t b = 0; b < bridge_.buses.size(); ++b) {
      const int bus = static_cast<int>(b);
      buses_.push_back(std::make_unique<can::MemoryBus>(
          can::BusConfig{.bitrate_bit_s = bridge_.buses[b].bitrate_bit_s}));
      ends_.push_back(buses_[b]->Join("bridge", bridge::ReceiveFilters(bridge_.bridge, bus)));
      bridge_ends.push_back(ends_.back().get());
      ends_.push_back(buses_[b]->Join("axes", virtual_axes::Filters(axes_file_.axes, bus)));
      axes_ends.push_back(ends_.back().get());
    }
    axes_ = std::make_unique<virtual_axes::VirtualAxes>(axes_file_.axes, *robot_, axes_ends);
    axes_->Start(0);
    buses_[0]->AddAgent([this] { return axes_->next_ns(); },
                        [this](std::int64_t now_ns) {
                          for (auto& bus : buses_) bus->AdvanceTo(now_ns);
                          axes_->Run(now_ns);
                        });
    plant_ = std::make_unique<bridge::CanPlant>(bridge_.bridge, bridge_ends);
    plant_->Reset(&sensors_);
    next_ns_ = buses_[0]->now_ns();
  }

  provider::OperatorResult Arm() {
    return cycle_->Take({kSession, types::Origin::kSim, types::OperatorAction::kArm}, tick_);
  }
  // One cycle; commands the reference of this time, 0 where it begins.
  void Step(double reference_s = 0.0) {
    provider::JointSetpoints command;
    command.header.session_id = kSession;
    command.header.tick = tick_;
    command.joint_count = kJoints;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto wanted = reference_.config.joints[j].trajectory->At(reference_s);
      command.mode[j] = types::ControlMode::kPosition;
      command.position_rad[j] = wanted.position_rad;
      command.velocity_rad_s[j] = wanted.velocity_rad_s;
    }
    (void)cycle_->Take(command, tick_);
    plant_->Step(cycle_->Command(tick_, sensors_), cycle_->period_s(), &sensors_);
    (void)cycle_->Observe(sensors_);
    (void)cycle_->ObserveBody(tick_, sensors_, body());
    ++tick_;
    next_ns_ += period_ns_;
    for (auto& bus : buses_) bus->AdvanceTo(next_ns_);
  }
  void StandFor(double seconds) {
    for (double t = 0.0; t < seconds; t += cycle_->period_s()) Step();
  }
  // Stands until the fall detector has started, arms, and lets the robot stand on its own.
  void StandUp() {
    StandFor(kDetectorStarts_s);
    ASSERT_EQ(Arm(), provider::OperatorResult::kDone) << cycle_->FallRefusal();
    StandFor(*axes_file_.axes.hold_start_s + 1.0);
    ASSERT_FALSE(axes_->held());
    ASSERT_EQ(state(), types::RobotState::kArmed) << message();
  }

  static constexpr double kDetectorStarts_s = 2.5;  // after 2 s of standing still

  types::RobotState state() const { return cycle_->state(); }
  // Why the robot has a fault.
  std::string message() const {
    return cycle_->fall_message().empty() ? sensors_.message : std::string(cycle_->fall_message());
  }
  const provider::PlantSensors& sensors() const { return sensors_; }
  const provider::BodySensors& body() const { return *plant_->body_sensors(); }
  const provider::BusReport& report() const { return *plant_->bus_report(); }
  const provider::ProviderCycle& cycle() const { return *cycle_; }
  const reference::LoadedReference& reference() const { return reference_; }
  virtual_axes::VirtualAxes& axes() { return *axes_; }
  // On the pelvis, world axes, from now on.
  void Push(const std::array<double, 3>& force_N) {
    provider::BodyDisturbance push;
    push.push_link = "pelvis";
    push.push_force_N = force_N;
    robot_->DisturbBody(push);
  }
  const virtual_axes::VirtualAxesConfig& axes_config() const { return axes_file_.axes; }
  const bridge::BridgeConfig& map() const { return bridge_.bridge; }
  // The robot itself: what no frame has passed.
  const provider::SimulatedPlant& robot() const { return *robot_; }

 private:
  static constexpr std::uint64_t kSession = 7;

  std::int64_t period_ns_;
  virtual_axes::VirtualAxesFile axes_file_;
  std::unique_ptr<provider::SimulatedPlant> robot_;
  reference::LoadedReference reference_;
  bridge::BridgeFile bridge_;
  std::unique_ptr<provider::ProviderCycle> cycle_;
  std::vector<std::unique_ptr<can::MemoryBus>> buses_;
  std::vector<std::unique_ptr<can::Transport>> ends_;
  std::unique_ptr<virtual_axes::VirtualAxes> axes_;
  std::unique_ptr<bridge::CanPlant> plant_;
  provider::PlantSensors sensors_;
  std::uint64_t tick_ = 0;
  std::int64_t next_ns_ = 0;
};

}  // namespace sinew
