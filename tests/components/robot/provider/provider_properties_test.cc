// The rules of docs/safety.md as an executable specification: random sequences of events drive
// ProviderCycle, and after every cycle what the plant would get is held against the rules. The
// specification knows what was said and when, not how the cycle decides.
//
// SINEW_SEQUENCES=10000000 runs as many sequences (10^7: four minutes); the default is for every
// build.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "components/robot/provider/provider_cycle.h"

namespace sinew::provider {
namespace {

using types::ControlMode;
using types::OperatorAction;
using types::Origin;
using types::RobotState;

constexpr std::uint64_t kOurs = 7;
constexpr int kJoints = 3;
constexpr double kUnit_Nm = 1e-3;  // command number n carries n times this, on every joint
constexpr std::int64_t kPeriod_ns = 4'166'667;
constexpr int kCycles = 40;

class Sequence {
 public:
  explicit Sequence(std::uint32_t seed) : random_(seed) {
    config_.session_id = kOurs;
    config_.joint_count = kJoints;
    config_.rate_Hz = 240.0;
    config_.ages_by_clock = Chance(2);
    config_.guard.live = Chance(2);
    config_.guard.missed_periods = 1 + Below(4);
    config_.guard.bridging = Chance(2) ? Bridging::kHold : Bridging::kDamp;
    config_.guard.on_joint_fault = static_cast<OtherJointsPolicy>(Below(4));
    config_.guard.valves_in_fault = Chance(2) ? ValvesInFault::kVent : ValvesInFault::kHold;
  }

  void Run() {
    ProviderCycle cycle(config_);
    PlantSensors sensors;
    std::int64_t now_ns = 0;
    for (std::uint64_t tick = 0; tick < kCycles; ++tick) {
      now_ns += Chance(30) ? Below(120) * 1'000'000LL : kPeriod_ns;  // a stall, now and then
      began_ns_.push_back(now_ns);
      (void)cycle.Begin(tick, now_ns);
      Leave(cycle.state());
      for (int events = Below(3); events > 0; --events) SayOperator(&cycle, tick);
      for (int events = Below(4); events > 0; --events) SayJoints(&cycle, tick);
      if (Chance(3)) SayValves(&cycle, tick);
      now_ns += Chance(40) ? Below(90) * 1'000'000LL : 1'000'000;
      const PlantCommand command = cycle.Command(tick, sensors, now_ns);
      Leave(cycle.state());
      Check(command, cycle.state(), sensors, tick, now_ns);
      if (::testing::Test::HasFatalFailure()) return;
      for (int j = 0; j < kJoints; ++j) {
        auto& fault = sensors.joint_fault[static_cast<std::size_t>(j)];
        if (fault.active() ? !Chance(10) : Chance(60)) {
          fault.cause = types::FaultCause::kOverspeed;
        } else {
          fault = {};
        }
        joint_failed_ = joint_failed_ || fault.active();
      }
      sensors.fault = Chance(60);
      (void)cycle.Observe(sensors);
      Leave(cycle.state());
    }
  }

 private:
  struct Said {
    types::MessageHeader header{.origin = Origin::kSim};
    int joint_count = 0;
    bool finite = true;
    bool while_armed = false;
  };

  int Below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool Chance(int one_in) { return Below(one_in) == 0; }
  std::uint64_t SomeSession() { return Chance(4) ? kOurs + 1 : kOurs; }
  Origin SomeOrigin() {
    return Chance(3) ? static_cast<Origin>(Below(3))
                     : (config_.guard.live ? Origin::kLive : Origin::kSim);
  }
  types::MessageHeader SomeHeader(std::uint64_t tick) {
    const int back = Chance(3) ? Below(8) - 2 : 0;
    const std::int64_t of = static_cast<std::int64_t>(tick) - back;
    return {.session_id = SomeSession(),
            .tick = static_cast<std::uint64_t>(std::max<std::int64_t>(of, 0)),
            .origin = SomeOrigin()};
  }

  void SayOperator(ProviderCycle* cycle, std::uint64_t tick) {
    const OperatorCommand command{
        .session_id = SomeSession(),
        .origin = SomeOrigin(),
        .action = Chance(2) ? OperatorAction::kArm : static_cast<OperatorAction>(Below(8))};
    const RobotState before = cycle->state();
    (void)cycle->Take(command, tick);
    const RobotState after = cycle->state();
    const bool allowed =
        command.session_id == kOurs &&
        (config_.guard.live ? command.origin == Origin::kLive : command.origin != Origin::kReplay);
    if (types::MayMove(after) && !types::MayMove(before)) {
      ASSERT_EQ(command.action, OperatorAction::kArm);
      ASSERT_TRUE(allowed) << "armed by somebody who may not";
      ASSERT_EQ(before, RobotState::kDisarmed) << "armed out of a latched state";
    }
    const bool was_latched = before == RobotState::kFault || before == RobotState::kEstopped;
    if (was_latched && after == RobotState::kDisarmed) {
      ASSERT_EQ(command.action, OperatorAction::kReset);
      ASSERT_TRUE(allowed) << "reset by somebody who may not";
    }
    if (command.action == OperatorAction::kEstop) {
      ASSERT_EQ(after, RobotState::kEstopped);
    }
    if (command.action == OperatorAction::kDisarm) {
      ASSERT_FALSE(types::MayMove(after));
    }
    if (command.action == OperatorAction::kHandover ||
        command.action == OperatorAction::kPermitReplay) {
      ASSERT_EQ(after, before) << "whoever drives, the provider arms for itself";
    }
    state_ = after;
    // Any other request, of a disturbance: the running session, and live where the plant is live.
    const types::MessageHeader header = SomeHeader(tick);
    ASSERT_EQ(cycle->Admits(header), header.session_id == kOurs &&
                                         (!config_.guard.live || header.origin == Origin::kLive));
  }

  void SayJoints(ProviderCycle* cycle, std::uint64_t tick) {
    Said said{.header = SomeHeader(tick), .joint_count = Chance(40) ? Below(kJoints) : kJoints};
    said.while_armed = types::MayMove(cycle->state());
    JointSetpoints command;
    command.header = said.header;
    command.joint_count = said.joint_count;
    command.mode.fill(ControlMode::kTorque);
    command.motor_torque_Nm.fill(kUnit_Nm * static_cast<double>(said_.size() + 1));
    if (Chance(15)) {
      const auto j = static_cast<std::size_t>(Below(kJoints));
      (Chance(2) ? command.motor_torque_Nm : command.position_rad)[j] =
          Chance(2) ? std::numeric_limits<double>::infinity()
                    : std::numeric_limits<double>::quiet_NaN();
      said.finite = false;
    }
    said_.push_back(said);
    (void)cycle->Take(command, tick);
  }

  void SayValves(ProviderCycle* cycle, std::uint64_t tick) {
    ValveCommand command;
    command.header = SomeHeader(tick);
    command.joint_count = kJoints;
    command.compressor_on.fill(true);
    command.valve_open.fill(Chance(2));
    (void)cycle->Take(command, tick);
  }

  // Latched states end by an operator only, never by themselves.
  void Leave(RobotState state) {
    const bool latched = state_ == RobotState::kEstopped || state_ == RobotState::kFault;
    ASSERT_TRUE(!latched || state == state_) << static_cast<int>(state);
    ASSERT_TRUE(state_ != RobotState::kDisarmed || !types::MayMove(state));
    state_ = state;
  }

  void Check(const PlantCommand& command, RobotState state, const PlantSensors& sensors,
             std::uint64_t tick, std::int64_t now_ns) {
    const bool stopped = state == RobotState::kFault || state == RobotState::kEstopped;
    const bool others_may_act = state == RobotState::kFault && joint_failed_ &&
                                (config_.guard.on_joint_fault == OtherJointsPolicy::kDamp ||
                                 config_.guard.on_joint_fault == OtherJointsPolicy::kHold);
    for (std::size_t j = 0; j < kJoints; ++j) {
      ASSERT_TRUE(std::isfinite(command.motor_torque_Nm[j]));
      ASSERT_TRUE(std::isfinite(command.position_rad[j]));
      const bool idle = command.mode[j] == ControlMode::kIdle;
      if (sensors.joint_fault[j].active()) {
        ASSERT_TRUE(idle) << "a joint with a fault";
      }
      if (!types::MayMove(state) && !others_may_act) {
        ASSERT_TRUE(idle) << "state " << static_cast<int>(state);
      }
      const auto number =
          static_cast<std::size_t>(std::llround(command.motor_torque_Nm[j] / kUnit_Nm));
      if (!idle && number > 0) CheckSaid(said_.at(number - 1), state, tick, now_ns);
      if (stopped) {
        const bool vents = config_.guard.valves_in_fault == ValvesInFault::kVent;
        ASSERT_FALSE(command.compressor_on[j]);
        ASSERT_EQ(command.valve_open[j], vents);
        ASSERT_EQ(command.vent_open[j], vents);
      }
    }
  }

  // A torque that somebody has sent reaches a joint now.
  void CheckSaid(const Said& said, RobotState state, std::uint64_t tick, std::int64_t now_ns) {
    ASSERT_EQ(state, RobotState::kArmed);
    ASSERT_EQ(said.header.session_id, kOurs);
    ASSERT_TRUE(said.while_armed) << "sent before the robot was armed";
    ASSERT_TRUE(!config_.guard.live || said.header.origin == Origin::kLive);
    ASSERT_LE(said.header.tick, tick) << "from the future";
    ASSERT_LT(tick - said.header.tick, static_cast<std::uint64_t>(config_.guard.missed_periods));
    ASSERT_TRUE(said.finite);
    ASSERT_EQ(said.joint_count, kJoints);
    if (!config_.ages_by_clock) return;
    const std::int64_t age_ns = now_ns - began_ns_[said.header.tick];
    ASSERT_LT(age_ns, (config_.guard.missed_periods + 1) * (kPeriod_ns + 1)) << "by the clock";
  }

  std::mt19937 random_;
  CycleConfig config_;
  std::vector<Said> said_;
  std::vector<std::int64_t> began_ns_;
  RobotState state_ = RobotState::kDisarmed;
  bool joint_failed_ = false;
};

TEST(ProviderProperties, RandomSequencesOfEventsKeepTheRules) {
  const char* wanted = std::getenv("SINEW_SEQUENCES");
  const long count = wanted != nullptr ? std::atol(wanted) : 20'000;
  ASSERT_GT(count, 0) << "SINEW_SEQUENCES";
  for (long seed = 0; seed < count; ++seed) {
    Sequence(static_cast<std::uint32_t>(seed)).Run();
    if (HasFatalFailure()) FAIL() << "sequence " << seed;
  }
}

}  // namespace
}  // namespace sinew::provider
