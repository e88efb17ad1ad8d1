// Controllers from outside of the tree take over in the moving rig, and give it back. Domains
// 74, 75.
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "tests/support/patient_guard.h"
#include "tests/support/program.h"
#include "tests/support/realtime.h"
#include "tests/support/sinew_program.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using OutsideClock = std::chrono::steady_clock;

const std::string kBin = SINEW_BIN_DIR;
const std::string kRigFolder = SINEW_SOURCE_DIR "/robots/rig/";
constexpr double kTorqueLimit_Nm = 0.398;                // robots/rig/surrogate_model.yaml
constexpr double kMostStep_Nm = 0.05 * kTorqueLimit_Nm;  // beyond what the motion itself asks for
constexpr double kMostError_rad = 0.05;
// Of the largest that either controller has by itself: another controller has another error.
constexpr double kMostOfOwnError = 1.5;
constexpr auto kHalfPeriod = 1250ms;  // robots/rig/reference_benchmark.yaml

node::Options OutsideObserver(int domain) {
  node::Options options;
  options.component = options.name = "observer";
  options.domain_id = domain;
  return options;
}

// The rig in real time, moving, with its own controller as owner.
class MovingRig {
 public:
  explicit MovingRig(int domain)
      : domain_(std::to_string(domain)),
        surrogate_({kBin + "/sinew-surrogate", "--config", PatientSurrogate(folder_), "--domain",
                    domain_, "--arm", "--rate", "100"}),
        pneumatics_(Line("sinew-pneumatics", "pneumatics.yaml")),
        reference_(Line("sinew-reference", "reference_benchmark.yaml")),
        control_(Line("sinew-control", "control_pid.yaml", {"--name", "own"})),
        node_(OutsideObserver(domain)),
        states_(node_.MakeReader(node::kJointState)),
        references_(node_.MakeReader(node::kReference)),
        commands_(node_.MakeReader(node::kJointCommand)),
        sources_(node_.MakeReader(node::kCommandSource)) {}

  std::vector<std::string> Line(const std::string& program, const std::string& config,
                                const std::vector<std::string>& more = {}) const {
    std::vector<std::string> line{kBin + "/" + program, "--config", kRigFolder + config, "--domain",
                                  domain_};
    line.insert(line.end(), more.begin(), more.end());
    if (MayBecomeRealtime()) line.push_back("--realtime");
    return line;
  }

  int HandOver(const std::string& name) {
    return Run({kSinew, "handover", "control", name, "--domain", domain_}).exit_code;
  }

  // What there is to see in a time.
  struct Seen {
    double largest_step_Nm = 0.0;  // of the command, from one tick to the next
    double largest_error_rad = 0.0;
    int commands = 0, fault_ticks = 0, idle_references = 0;
    int pairs = 0;  // of a state and its reference
  };
  Seen Watch(std::chrono::milliseconds time) { return Watch(time, Seen()); }
  Seen Watch(std::chrono::milliseconds time, Seen seen) {
    const auto end = OutsideClock::now() + time;
    while (OutsideClock::now() < end) {
      node_.WaitForData(5ms);
      while (const auto source = sources_.TakeNext()) {
        driver_ = source->joint_command_participant;
      }
      while (const auto state = states_.TakeNext()) {
        seen.fault_ticks += state->robot_state == msg::RobotState::kFault ? 1 : 0;
        position_rad_[state->header.tick] = state->position_rad[0];
        Compare(state->header.tick, &seen);
      }
      while (const auto reference = references_.TakeNext()) {
        seen.idle_references += reference->idle ? 1 : 0;
        reference_rad_[reference->header.tick] = reference->position_rad[0];
        Compare(reference->header.tick, &seen);
      }
      while (const auto command = commands_.TakeNext()) {
        ++seen.commands;
        const double torque_Nm = command->motor_torque_Nm[0];
        if (command->header.tick == last_tick_ + 1) {
          seen.largest_step_Nm = std::max(seen.largest_step_Nm, std::abs(torque_Nm - torque_Nm_));
        }
        last_tick_ = command->header.tick;
        torque_Nm_ = torque_Nm;
      }
    }
    return seen;
  }
  bool WatchUntilDrivenBy(const std::string& name, Seen* seen) {
    const auto end = OutsideClock::now() + 10s;
    while (driver_ != name && OutsideClock::now() < end) *seen = Watch(20ms, *seen);
    return driver_ == name;
  }
  const std::string& driver() const { return driver_; }
  // Of a writer of joint_command.
  std::uint32_t StrengthOf(const std::string& name) const {
    for (const node::Endpoint& endpoint : node_.Endpoints()) {
      const bool of_topic = endpoint.is_writer && endpoint.topic == node::kJointCommand.name;
      if (of_topic && endpoint.participant == name) return endpoint.strength;
    }
    return 0;
  }

 private:
  // Whichever of the two comes last.
  void Compare(std::uint64_t tick, Seen* seen) const {
    const auto position = position_rad_.find(tick), reference = reference_rad_.find(tick);
    if (position == position_rad_.end() || reference == reference_rad_.end()) return;
    ++seen->pairs;
    seen->largest_error_rad =
        std::max(seen->largest_error_rad, std::abs(reference->second - position->second));
  }

  std::string domain_;
  TemporaryFolder folder_;
  Program surrogate_, pneumatics_, reference_, control_;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::Reference> references_;
  node::Reader<msg::JointCommand> commands_;
  node::Reader<msg::CommandSource> sources_;
  std::map<std::uint64_t, double> position_rad_, reference_rad_;  // by tick
  std::string driver_;
  std::uint64_t last_tick_ = 0;
  double torque_Nm_ = 0.0;
};

struct Outside {
  std::string program;
  int domain;
  bool is_participant;  // by our library: it has its options
};

// What went wrong; empty: nothing.
std::string TakeOverAndGiveBack(const Outside& which) {
  MovingRig rig(which.domain);
  MovingRig::Seen there, alone, back, unused;
  if (!rig.WatchUntilDrivenBy("own", &unused)) return "nobody drives";
  std::vector<std::string> line{SINEW_TEST_BIN_DIR "/" + which.program, "--name", "outside",
                                "--domain", std::to_string(which.domain)};
  if (which.is_participant && MayBecomeRealtime()) line.push_back("--realtime");
  Program outside(line);
  const auto said = [&outside] { return "\noutside says:\n" + outside.error(); };
  // Joined, settled below the owner, and past the soft start of the reference.
  (void)rig.Watch(3000ms);
  if (rig.driver() != "own") return "who is started later drives";
  const std::uint32_t joined = rig.StrengthOf("outside"), owner = rig.StrengthOf("own");
  if (joined <= 1 || joined >= owner) {
    return "strength " + std::to_string(joined) + " beside " + std::to_string(owner);
  }
  const MovingRig::Seen before = rig.Watch(kHalfPeriod);

  if (rig.HandOver("outside") != 0) return "not handed over" + said();
  if (!rig.WatchUntilDrivenBy("outside", &there)) {
    return "the provider does not obey it but '" + rig.driver() + "'" + said();
  }
  there = rig.Watch(kHalfPeriod, there);
  alone = rig.Watch(kHalfPeriod);
  if (rig.HandOver("own") != 0) return "not handed back";
  if (!rig.WatchUntilDrivenBy("own", &back)) return "the provider does not obey its own again";
  back = rig.Watch(kHalfPeriod, back);
  std::printf(
      "step %.4f N m before, %.4f and %.4f with the handovers; error %.4f, %.4f, %.4f, alone %.4f "
      "rad\n",
      before.largest_step_Nm, there.largest_step_Nm, back.largest_step_Nm, before.largest_error_rad,
      there.largest_error_rad, back.largest_error_rad, alone.largest_error_rad);
  const double most_error_rad =
      std::max(kMostError_rad,
               kMostOfOwnError * std::max(before.largest_error_rad, alone.largest_error_rad));
  for (const MovingRig::Seen& seen : {there, back}) {
    if (seen.largest_step_Nm > before.largest_step_Nm + kMostStep_Nm) return "a step of the torque";
    if (seen.largest_error_rad > most_error_rad) return "a tracking error";
    if (seen.fault_ticks != 0) return "a fault of the robot";
    if (seen.idle_references != 0 || seen.commands < 50) return "the rig stood still";
    if (seen.pairs < 50) return "the error was seen " + std::to_string(seen.pairs) + " times";
  }
  outside.Signal(SIGTERM);
  return outside.Wait(2s) == 0 ? "" : "it did not end in order";
}

class OutsideControllers : public ::testing::TestWithParam<Outside> {};

TEST_P(OutsideControllers, TakeOverInTheMovingRigWithoutAJumpAndGiveItBack) {
  ::setenv("CYCLONEDDS_URI", "file://" SINEW_SOURCE_DIR "/tests/install/cyclone/loopback.xml", 1);
  EXPECT_EQ(TakeOverAndGiveBack(GetParam()), "");
}

INSTANTIATE_TEST_SUITE_P(System, OutsideControllers,
                         ::testing::Values(Outside{"pid-controller", 74, true},
                                           Outside{"cyclone-controller", 75, false}),
                         [](const auto& outside) {
                           return outside.param.domain == 74 ? std::string("Installed")
                                                             : std::string("Cyclone");
                         });

}  // namespace
}  // namespace sinew::testing
