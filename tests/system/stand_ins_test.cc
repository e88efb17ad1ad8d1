// The rig in lockstep with stand-ins in the place of participants. Domains 161 to 163.
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/simulation.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

#include "components/topics/node/codec.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recording_payloads.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kRobot = SINEW_SOURCE_DIR "/robots/rig/";
constexpr std::size_t kSeconds = 9;
constexpr std::size_t kTicks = kSeconds * 240;
constexpr std::size_t kMoving = 3 * 240;  // start delay and soft start of the reference are over

using Recording = std::map<std::string, std::vector<std::string>>;

Recording RunRig(const std::string& deployment, int domain, const std::filesystem::path& file,
                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{kSinew,
                                     "launch",
                                     kRobot + deployment,
                                     "--set",
                                     "mode=lockstep",
                                     "--duration",
                                     std::to_string(kSeconds),
                                     "--seed",
                                     "7",
                                     "--domain",
                                     std::to_string(domain),
                                     "--record",
                                     file.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 150s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  return PayloadsByTopic(file);
}

template <class Message>
std::vector<Message> Messages(const Recording& recording, const std::string& topic) {
  std::vector<Message> messages;
  const auto found = recording.find(topic);
  if (found == recording.end()) return messages;
  for (const std::string& payload : found->second) {
    node::Bytes bytes(payload.size());
    std::memcpy(bytes.data(), payload.data(), payload.size());
    messages.emplace_back();
    EXPECT_TRUE(node::Decode(bytes, &messages.back())) << topic;
  }
  return messages;
}

// Of the joint against its reference while it moves, rad.
double TrackingError(const Recording& recording) {
  const auto states = Messages<msg::JointState>(recording, "joint_state");
  const auto references = Messages<msg::Reference>(recording, "reference");
  EXPECT_EQ(states.size(), kTicks);
  EXPECT_EQ(references.size(), kTicks);
  double sum = 0.0;
  for (std::size_t k = kMoving; k < std::min(states.size(), references.size()); ++k) {
    const double error = states[k].position_rad[0] - references[k].position_rad[0];
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(kTicks - kMoving));
}

class StandIns : public ::testing::Test {
 protected:
  // The rig with its own participants: recorded once.
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    original_ = new Recording(RunRig("deploy_esn.yaml", 161, folder_->path() / "original.mcap"));
  }
  static void TearDownTestSuite() {
    delete original_;
    delete folder_;
  }
  static std::filesystem::path Path(const std::string& name) { return folder_->path() / name; }

  static TemporaryFolder* folder_;
  static Recording* original_;
};
TemporaryFolder* StandIns::folder_ = nullptr;
Recording* StandIns::original_ = nullptr;

// The detector against the truth that the surrogate publishes in the same run.
TEST_F(StandIns, TheDetectorAgreesWithThePublishedTruth) {
  const auto truth = Messages<msg::SimTruth>(*original_, "sim_truth");
  const auto regime = Messages<msg::RegimeState>(*original_, "regime");
  ASSERT_EQ(truth.size(), kTicks);
  ASSERT_EQ(regime.size(), kTicks);
  std::size_t same = 0, inside = 0;
  for (std::size_t k = kMoving; k < kTicks; ++k) {
    const bool free = truth[k].contact[0] == msg::ContactSide::kNone;
    inside += free ? 1 : 0;
    const bool sea = regime[k].regime[0] == msg::RegimeKind::kSea;
    same += regime[k].regime[0] != msg::RegimeKind::kUnknown && sea == free ? 1 : 0;
    EXPECT_EQ(truth[k].joint_count, 1);
    EXPECT_NEAR(truth[k].backlash_rad[0], 2.66 * M_PI / 180.0, 0.01);
  }
  const double total = static_cast<double>(kTicks - kMoving);
  std::printf("detector right in %.1f %% of ticks, inside in %.1f %%\n", 100.0 * same / total,
              100.0 * inside / total);
  EXPECT_GT(same / total, 0.9);
  // At rest the teeth are in the middle of the play; under 4 bar they do not leave their side.
  EXPECT_EQ(truth[0].contact[0], msg::ContactSide::kNone);
  EXPECT_NEAR(truth[0].play_angle_rad[0], 0.5 * truth[0].backlash_rad[0], 1e-6);
}

TEST_F(StandIns, IdealPressureTrueRegimeAndTheModelDriveTheRig) {
  const Recording run = RunRig("deploy_stand_ins.yaml", 162, Path("stand_ins.mcap"));

  const auto inside = Messages<msg::ActuatorState>(run, "actuator_state");
  const auto state = Messages<msg::PneumaticState>(run, "pneumatic_state");
  const auto valves = Messages<msg::ValveCommand>(run, "valve_command");
  ASSERT_EQ(inside.size(), kTicks);
  ASSERT_EQ(state.size(), kTicks);
  ASSERT_EQ(valves.size(), kTicks);
  for (std::size_t k = 1; k < kTicks; ++k) {
    // The sensor: five times its noise of 6 mbar, and a count of 10 mbar.
    ASSERT_NEAR(inside[k].chamber_pressure_bar[0], 4.0, 0.04) << "tick " << k;
    ASSERT_EQ(state[k].target_pressure_bar[0], 4.0);
    ASSERT_TRUE(state[k].settled[0]);
    ASSERT_FALSE(valves[k].valve_open[0] || valves[k].compressor_on[0]);
  }

  const auto truth = Messages<msg::SimTruth>(run, "sim_truth");
  const auto regime = Messages<msg::RegimeState>(run, "regime");
  ASSERT_EQ(truth.size(), kTicks);
  ASSERT_EQ(regime.size(), kTicks);
  for (std::size_t k = 0; k < kTicks; ++k) {
    const bool free = truth[k].contact[0] == msg::ContactSide::kNone;
    ASSERT_EQ(regime[k].regime[0], free ? msg::RegimeKind::kSea : msg::RegimeKind::kPea)
        << "tick " << k;
    ASSERT_EQ(regime[k].phase[0], msg::RegimePhase::kExecution);
    ASSERT_EQ(regime[k].confidence[0], 1.0);
    ASSERT_FALSE(regime[k].stale);
  }

  EXPECT_EQ(Messages<msg::TorquePrediction>(run, "torque_prediction").size(), kTicks);
  EXPECT_EQ(run.count("reservoir_state"), 0u);
  const double original = TrackingError(*original_), stand_in = TrackingError(run);
  std::printf("tracking error %.2f mrad, with stand-ins %.2f mrad\n", 1e3 * original,
              1e3 * stand_in);
  EXPECT_LT(stand_in, 3.0 * original);
  EXPECT_GT(stand_in, 0.0);
}

TEST_F(StandIns, ARecordedReferenceAndAFrozenReadoutTakeTheirPlaces) {
  const auto recorded = Messages<msg::Reference>(*original_, "reference");
  ASSERT_EQ(recorded.size(), kTicks);
  std::size_t first = 0;
  while (first < kTicks && recorded[first].idle) ++first;
  ASSERT_LT(first, kTicks);
  const std::filesystem::path config = Path("recorded.yaml");
  std::ofstream(config) << "schema: sinew-recorded-reference/1\nrecording: original.mcap\n"
                        << "soft_start_s: 0.25\n";  // 60 ticks

  const Recording run =
      RunRig("deploy_esn.yaml", 163, Path("recorded.mcap"),
             {"--set", "reference.program=" SINEW_BIN_DIR "/sinew-recorded-reference", "--set",
              "reference.config=" + config.string(), "--set",
              "rls.program=" SINEW_BIN_DIR "/sinew-frozen-readout"});
  const auto played = Messages<msg::Reference>(run, "reference");
  ASSERT_EQ(played.size(), kTicks);
  constexpr std::size_t kSoftStart = 60;
  std::size_t started = 0;
  while (started < kTicks && played[started].idle) ++started;
  // The recording ends before this run, in the middle of a motion: then it comes to rest softly.
  const std::size_t end = std::min(kTicks, kTicks - first + started + kSoftStart);
  ASSERT_GT(end, kMoving);
  for (std::size_t k = started + kSoftStart; k < end; ++k) {
    const msg::Reference& then = recorded[first + k - started - kSoftStart];
    // Past the soft start the recorded values themselves, at the running session's ticks.
    ASSERT_EQ(played[k].position_rad[0], then.position_rad[0]) << "tick " << k;
    ASSERT_EQ(played[k].velocity_rad_s[0], then.velocity_rad_s[0]) << "tick " << k;
    ASSERT_EQ(played[k].header.origin, msg::Origin::kReplay);
    ASSERT_EQ(played[k].header.tick, k);
  }
  // What is computed from it says so too.
  EXPECT_EQ(Messages<msg::JointCommand>(run, "joint_command")[kMoving].header.origin,
            msg::Origin::kReplay);

  const auto readouts = Messages<msg::Readout>(run, "readout");
  const auto adaptation = Messages<msg::AdaptationState>(run, "adaptation_state");
  ASSERT_EQ(readouts.size(), kTicks);
  ASSERT_EQ(adaptation.size(), kTicks);
  for (std::size_t k = 0; k < kTicks; ++k) {
    ASSERT_EQ(readouts[k].version, 0u);
    ASSERT_TRUE(adaptation[k].frozen);
    ASSERT_FALSE(adaptation[k].stale);
  }
  // As the adapter's before its first update: the readout as trained.
  const msg::Readout trained = Messages<msg::Readout>(*original_, "readout").at(0);
  ASSERT_EQ(trained.version, 0u);
  ASSERT_EQ(readouts[kMoving].network, trained.network);
  EXPECT_EQ(readouts[kMoving].weight, trained.weight);
  const double original = TrackingError(*original_), stand_in = TrackingError(run);
  std::printf("tracking error %.2f mrad, with stand-ins %.2f mrad\n", 1e3 * original,
              1e3 * stand_in);
  EXPECT_LT(stand_in, 3.0 * original);
}

}  // namespace
}  // namespace sinew::testing
