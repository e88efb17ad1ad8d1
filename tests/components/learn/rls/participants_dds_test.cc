// sinew-esn and sinew-rls as processes in lockstep. The test plays state provider, reference,
// regime and control.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>

#include <cmath>
#include <fstream>
#include <vector>

#include "components/base/types/regime.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/learn/esn/predictor.h"
#include "components/topics/node/node.h"
#include "components/topics/node/tick_loop.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using sinew::testing::Program;
using sinew::testing::TemporaryFolder;

constexpr double kPeriod_s = 1.0 / 240.0;
constexpr auto kLimit = 20s;
// robots/rig/model.yaml: drive torque at the output of one ampere.
constexpr double kTorquePerAmpere_Nm = 0.77 * 100.0 * 0.0159155;

esn::Weights SomeWeights(const std::string& network, double constant_Nm, std::uint64_t seed) {
  esn::Hyperparameters hyper;
  hyper.neurons = 30;
  hyper.leak = 0.5;
  hyper.seed = seed;
  esn::Weights weights = esn::MakeWeights(hyper, 2, 1);
  weights.network = network;
  weights.target = "drive_torque_Nm";
  weights.period_s = kPeriod_s;
  weights.inputs = {{esn::Signal::kReferencePosition, 0}, {esn::Signal::kChamberPressure, 0}};
  weights.readout(0, 0) = constant_Nm;
  return weights;
}

double ReferenceAt(std::uint64_t tick) { return 0.5 * std::sin(0.05 * static_cast<double>(tick)); }
double PressureAt(std::uint64_t tick) { return 3.0 + std::cos(0.013 * static_cast<double>(tick)); }
// What the motor really puts out, whatever was predicted.
double TruthAt(std::uint64_t tick) {
  return 1.0 + 4.0 * ReferenceAt(tick) - 0.5 * PressureAt(tick);
}

template <class Message>
Message Stamped(std::uint64_t tick) {
  Message message;
  message.header.session_id = 77;
  message.header.tick = tick;
  message.header.stamp_ns = static_cast<std::int64_t>(static_cast<double>(tick) * kPeriod_s * 1e9);
  message.header.origin = msg::Origin::kSim;
  return message;
}

class Lockstep {
 public:
  explicit Lockstep(int domain) : node_(MakeOptions(domain)) {}

  // Publishes the tick and returns its prediction; then answers as control and motor do.
  void Tick(std::uint64_t tick, msg::RegimeKind regime, bool last) {
    auto state = Stamped<msg::JointState>(tick);
    state.robot_state = msg::RobotState::kArmed;
    state.last_tick = last;
    state.period_s = kPeriod_s;
    state.joint_count = 1;
    state.velocity_rad_s[0] = 1.0;
    state.valid[0] = true;
    auto actuator = Stamped<msg::ActuatorState>(tick);
    actuator.joint_count = 1;
    actuator.chamber_pressure_bar[0] = PressureAt(tick);
    actuator.motor_current_A[0] = tick == 0 ? 0.0 : TruthAt(tick - 1) / kTorquePerAmpere_Nm;
    actuator.valid[0] = true;
    auto reference = Stamped<msg::Reference>(tick);
    reference.joint_count = 1;
    reference.position_rad[0] = ReferenceAt(tick);
    auto regime_state = Stamped<msg::RegimeState>(tick);
    regime_state.joint_count = 1;
    regime_state.regime[0] = regime;
    auto command = Stamped<msg::JointCommand>(tick);
    command.joint_count = 1;
    command.mode[0] = msg::CommandMode::kTorque;
    ASSERT_EQ(actuator_.Write(actuator), node::WriteStatus::kOk);
    ASSERT_EQ(reference_.Write(reference), node::WriteStatus::kOk);
    ASSERT_EQ(regime_.Write(regime_state), node::WriteStatus::kOk);
    ASSERT_EQ(state_.Write(state), node::WriteStatus::kOk);
    const auto prediction = prediction_.WaitNext(kLimit);
    ASSERT_TRUE(prediction.has_value()) << "no prediction for tick " << tick;
    ASSERT_EQ(prediction->header.tick, tick);
    predictions.push_back(*prediction);
    ASSERT_EQ(command_.Write(command), node::WriteStatus::kOk);
    const auto readout = readout_.WaitNext(kLimit);
    ASSERT_TRUE(readout.has_value()) << "no readout for tick " << tick;
    ASSERT_EQ(readout->header.tick, tick);
    readouts.push_back(*readout);
    const auto adaptation = adaptation_.WaitNext(kLimit);
    ASSERT_TRUE(adaptation.has_value());
    adaptations.push_back(*adaptation);
  }

  std::vector<msg::TorquePrediction> predictions;
  std::vector<msg::Readout> readouts;
  std::vector<msg::AdaptationState> adaptations;

 private:
  static node::Options MakeOptions(int domain) {
    node::Options options;
    options.component = options.name = "test";
    options.domain_id = domain;
    options.mode = node::TimeMode::kLockstep;
    return options;
  }

  node::Node node_;
  node::Writer<msg::JointState> state_ = node_.MakeWriter(node::kJointState);
  node::Writer<msg::ActuatorState> actuator_ = node_.MakeWriter(node::kActuatorState);
  node::Writer<msg::Reference> reference_ = node_.MakeWriter(node::kReference);
  node::Writer<msg::RegimeState> regime_ = node_.MakeWriter(node::kRegime);
  node::Writer<msg::JointCommand> command_ = node_.MakeWriter(node::kJointCommand);
  node::Reader<msg::TorquePrediction> prediction_ = node_.MakeReader(node::kTorquePrediction);
  node::Reader<msg::Readout> readout_ = node_.MakeReader(node::kReadout);
  node::Reader<msg::AdaptationState> adaptation_ = node_.MakeReader(node::kAdaptationState);
};

std::string Program_(const char* name) { return std::string(SINEW_BIN_DIR) + "/" + name; }

class LearningDds : public ::testing::Test {
 protected:
  LearningDds() {
    esn::SaveWeights(folder_.path() / "sea.json", sea_);
    esn::SaveWeights(folder_.path() / "pea.json", pea_);
    std::ofstream(folder_.path() / "esn.yaml")
        << "schema: sinew-esn-participant/1\nsea_weights: sea.json\n"
           "pea_weights: pea.json\nadaptation: true\n";
    std::ofstream(folder_.path() / "rls.yaml")
        << "schema: sinew-rls-participant/1\nsea_weights: sea.json\npea_weights: pea.json\nmodel: "
        << SINEW_SOURCE_DIR
        << "/robots/rig/model.yaml\ncarry_over: false\ninitial_innovation_Nm: 0.5\n";
  }

  // A session of both programs; SEA for the first half, PEA for the second, unknown for the last
  // ten ticks.
  void RunSession(int domain, std::uint64_t ticks, Lockstep* lockstep) {
    Program esn({Program_("sinew-esn"), "--domain", std::to_string(domain), "--lockstep",
                 "--log-level", "error", "--config", (folder_.path() / "esn.yaml").string()});
    Program rls({Program_("sinew-rls"), "--domain", std::to_string(domain), "--lockstep",
                 "--log-level", "error", "--config", (folder_.path() / "rls.yaml").string()});
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      const msg::RegimeKind regime = tick + 10 >= ticks ? msg::RegimeKind::kUnknown
                                     : tick < ticks / 2 ? msg::RegimeKind::kSea
                                                        : msg::RegimeKind::kPea;
      lockstep->Tick(tick, regime, tick + 1 == ticks);
      ASSERT_FALSE(HasFatalFailure()) << "esn says: " << esn.error() << "rls says: " << rls.error();
    }
    EXPECT_EQ(esn.Wait(kLimit), 0) << esn.error();
    EXPECT_EQ(rls.Wait(kLimit), 0) << rls.error();
  }

  TemporaryFolder folder_;
  esn::Weights sea_ = SomeWeights("sea", 0.7, 1);
  esn::Weights pea_ = SomeWeights("pea", -0.7, 2);
};

constexpr std::uint64_t kTicks = 1200;

TEST_F(LearningDds, PredictionsAreThoseOfTheNetworksWithTheReadoutOfTheTickBefore) {
  Lockstep lockstep(80);
  ASSERT_NO_FATAL_FAILURE(RunSession(80, kTicks, &lockstep));
  esn::Predictor expected(sea_, pea_);
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    if (tick > 0) {
      const msg::Readout& readout = lockstep.readouts[tick - 1];
      const Eigen::Map<const Eigen::RowVectorXd> weights(readout.weight.data(),
                                                         readout.feature_count);
      ASSERT_TRUE(
          expected.SetReadout(static_cast<esn::Which>(readout.network), readout.version, weights));
    }
    esn::Frame frame;
    frame.Set(esn::Signal::kReferencePosition, 0, ReferenceAt(tick));
    frame.Set(esn::Signal::kChamberPressure, 0, PressureAt(tick));
    const bool unknown = tick + 10 >= kTicks;
    const esn::Prediction p = expected.Step(frame, unknown             ? types::Regime::kUnknown
                                                   : tick < kTicks / 2 ? types::Regime::kSea
                                                                       : types::Regime::kPea);
    const msg::TorquePrediction& got = lockstep.predictions[tick];
    ASSERT_EQ(got.torque_Nm[0], p.torque_Nm[0]) << tick;
    ASSERT_EQ(got.sea_torque_Nm[0], p.sea_torque_Nm[0]) << tick;
    ASSERT_EQ(got.pea_torque_Nm[0], p.pea_torque_Nm[0]) << tick;
    ASSERT_EQ(got.valid[0], !unknown) << tick;
    ASSERT_FALSE(got.stale) << tick;
    ASSERT_EQ(got.reference_tick, tick);
    ASSERT_EQ(got.readout_tick, tick == 0 ? node::kNoTick : tick - 1);
  }
}

TEST_F(LearningDds, AdaptationFindsTheTorqueOfTheMotor) {
  Lockstep lockstep(81);
  ASSERT_NO_FATAL_FAILURE(RunSession(81, kTicks, &lockstep));
  const auto rms = [&](std::uint64_t begin, std::uint64_t end) {
    double sum = 0.0;
    for (std::uint64_t t = begin; t < end; ++t) {
      sum += std::pow(lockstep.predictions[t].torque_Nm[0] - TruthAt(t), 2);
    }
    return std::sqrt(sum / static_cast<double>(end - begin));
  };
  EXPECT_GT(rms(0, 20), 0.5);
  // The truth is linear in the inputs, which are features. Both networks find it, each in its half.
  EXPECT_LT(rms(kTicks / 2 - 100, kTicks / 2), 0.02);
  EXPECT_GT(rms(kTicks / 2, kTicks / 2 + 20), 0.5);
  EXPECT_LT(rms(kTicks - 110, kTicks - 10), 0.02);
  EXPECT_TRUE(lockstep.adaptations[0].frozen) << "nothing to learn from in the first tick";
  EXPECT_FALSE(lockstep.adaptations[5].frozen);
  EXPECT_TRUE(lockstep.adaptations[kTicks - 1].frozen) << "the regime is unknown";
  EXPECT_GT(lockstep.readouts.back().version, kTicks / 2);
  EXPECT_EQ(lockstep.readouts.back().network, 1);
}

TEST_F(LearningDds, TheSameSessionTwiceGivesTheSameBits) {
  Lockstep first(82);
  Lockstep second(83);
  ASSERT_NO_FATAL_FAILURE(RunSession(82, 300, &first));
  ASSERT_NO_FATAL_FAILURE(RunSession(83, 300, &second));
  EXPECT_EQ(first.predictions, second.predictions);
  EXPECT_EQ(first.readouts, second.readouts);
  EXPECT_EQ(first.adaptations, second.adaptations);
}

TEST_F(LearningDds, BadConfigurationIsOneLineAndExitCodeTwo) {
  std::ofstream(folder_.path() / "bad.yaml")
      << "schema: sinew-esn-participant/1\npea_weights: bad.json\n";
  std::string text = esn::FormatWeights(pea_);
  text.replace(text.find("\"bias\": [") + 9, 1, "x");
  std::ofstream(folder_.path() / "bad.json") << text;
  for (const char* program : {"sinew-esn", "sinew-rls"}) {
    for (const std::string& config :
         {(folder_.path() / "bad.yaml").string(), std::string("/no/such.yaml")}) {
      const auto result = sinew::testing::Run(
          {Program_(program), "--domain", "84", "--log-level", "error", "--config", config});
      EXPECT_EQ(result.exit_code, 2) << program << " " << result.error;
      EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << result.error;
    }
  }
}

}  // namespace
}  // namespace sinew
