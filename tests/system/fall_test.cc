// The biped's guard against falls where it is deployed: world, reference, control and disturbance
// as processes in lockstep. Domains 192 to 195. Many runs: bench/falls.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "components/base/types/angle.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recorded_messages.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kRate_Hz = 240.0;
constexpr std::size_t kWithin_ticks = 24;  // 100 ms
constexpr double kActs_s = 5.0;

struct FallSession {
  std::string log;
  std::vector<msg::JointState> states;
  std::vector<msg::ActuatorState> actuators;
  std::vector<msg::SimBodyTruth> truth;

  // First tick whose state is a fault.
  std::optional<std::size_t> fault() const {
    const auto found = std::find_if(states.begin(), states.end(), [](const auto& state) {
      return state.robot_state == msg::RobotState::kFault;
    });
    if (found == states.end()) return std::nullopt;
    return static_cast<std::size_t>(found - states.begin());
  }
  // First tick in which the truth has the base tilted by more than 30 degrees.
  std::optional<std::size_t> tilted() const {
    const auto found = std::find_if(truth.begin(), truth.end(), [](const auto& body) {
      const auto& q = body.orientation_wxyz;
      return 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]) < std::cos(30.0 * types::kDegree_rad);
    });
    if (found == truth.end()) return std::nullopt;
    return static_cast<std::size_t>(found - truth.begin());
  }
};

// `disturbances`: entries of a sinew-body-disturbance/1 file; empty: that of the robot's folder.
FallSession Launch(int domain, const std::string& disturbances,
                   const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  std::vector<std::string> arguments{kSinew,
                                     "launch",
                                     SINEW_SOURCE_DIR "/robots/biped/deploy_fall.yaml",
                                     "--domain",
                                     std::to_string(domain),
                                     "--record",
                                     file};
  if (!disturbances.empty()) {
    const std::string config = folder.Write(
        "fall.yaml", "schema: sinew-body-disturbance/1\ndisturbances:\n" + disturbances);
    arguments.insert(arguments.end(), {"--set", "disturbance.config=" + config});
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 200s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  const auto recording = PayloadsByTopic(file);
  return {run.output + run.error, MessagesOf<msg::JointState>(recording, "joint_state"),
          MessagesOf<msg::ActuatorState>(recording, "actuator_state"),
          MessagesOf<msg::SimBodyTruth>(recording, "sim_body_truth")};
}

// The motors: no current in any joint from the fault on, to the end of the session.
void ExpectFoundAndMotorsOff(const FallSession& session) {
  const std::optional<std::size_t> fault = session.fault(), tilted = session.tilted();
  ASSERT_TRUE(fault) << session.log;
  ASSERT_TRUE(tilted) << "this is no fall";
  EXPECT_GT(static_cast<double>(*fault), kActs_s * kRate_Hz);
  EXPECT_LE(*fault, *tilted + kWithin_ticks);
  EXPECT_THAT(session.log, HasSubstr("fault: fall: "));
  ASSERT_EQ(session.actuators.size(), session.states.size());
  for (std::size_t k = *fault + 1; k < session.states.size(); ++k) {
    ASSERT_EQ(session.states[k].robot_state, msg::RobotState::kFault) << k;
    for (const double current_A : session.actuators[k].motor_current_A) {
      ASSERT_EQ(current_A, 0.0) << k;
    }
  }
}

TEST(Fall, APushThatTopplesTheRobotIsAFaultAndTheMotorsAreOff) {
  ExpectFoundAndMotorsOff(Launch(192, ""));
}

TEST(Fall, AKneeWithoutItsDriveIsAFaultAndTheMotorsAreOff) {
  ExpectFoundAndMotorsOff(Launch(193, "  - {at_s: 5, lost_drive: left_knee}\n"));
}

TEST(Fall, FeetThatSlipAreAFaultAndTheMotorsAreOff) {
  ExpectFoundAndMotorsOff(
      Launch(194,
             "  - {at_s: 5, lost_friction: 0.95}\n"
             "  - {at_s: 5, for_s: 0.3, push: {link: torso, force_N: [-40, 0, 0], "
             "place_m: [0, 0, 0.0715]}}\n"));
}

TEST(Fall, HealthySquatsAndASmallPushAreNone) {
  const FallSession session =
      Launch(195,
             "  - {at_s: 5, for_s: 0.2, push: {link: torso, force_N: [8, 4, 0], "
             "place_m: [0, 0, 0.0715]}}\n",
             {"--duration", "15"});
  EXPECT_FALSE(session.fault()) << session.log;
  EXPECT_FALSE(session.tilted());
  EXPECT_THAT(session.log, HasSubstr("fall detector: upright"));
}

}  // namespace
}  // namespace sinew::testing
