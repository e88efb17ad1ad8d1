// Configuration of sinew-esn and sinew-rls.
#include "components/base/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "components/learn/esn/file/esn_config.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/learn/rls/file/rls_config.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class LearningConfig : public testing::Test {
 protected:
  LearningConfig() {
    folder_ =
        fs::path(testing::TempDir()) /
        ("sinew_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
    esn::Hyperparameters hyper;
    hyper.neurons = 10;
    esn::Weights weights = esn::MakeWeights(hyper, 1, 1);
    weights.inputs = {{esn::Signal::kReferencePosition, 0}};
    weights.target = "drive_torque_Nm";
    weights.period_s = 1.0 / 240.0;
    weights.network = "pea";
    esn::SaveWeights(folder_ / "pea.json", weights);
    weights.network = "sea";
    esn::SaveWeights(folder_ / "sea.json", weights);
    weights.target = "load_torque_Nm";
    esn::SaveWeights(folder_ / "load.json", weights);
  }
  ~LearningConfig() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& text) {
    std::ofstream(folder_ / "c.yaml") << text;
    return folder_ / "c.yaml";
  }
  static std::string MessageOf(const std::function<void()>& act) {
    try {
      act();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_;
};

const std::string kModel = std::string("model: ") + SINEW_SOURCE_DIR + "/robots/rig/model.yaml\n";

TEST_F(LearningConfig, EsnReadsNetworksRelativeToItsFile) {
  const esn::EsnConfig config =
      esn::LoadEsnConfig(Write("schema: sinew-esn-participant/1\nsea_weights: "
                               "sea.json\npea_weights: pea.json\nadaptation: true\n"));
  EXPECT_EQ(config.mode, esn::EsnConfig::Mode::kNetwork);
  EXPECT_EQ(config.sea->network, "sea");
  EXPECT_EQ(config.pea->network, "pea");
  EXPECT_TRUE(config.adaptation);
}

TEST_F(LearningConfig, EsnTakesWeightsFromTheCommandLineFirst) {
  const esn::EsnConfig config = esn::LoadEsnConfig(
      Write("schema: sinew-esn-participant/1\npea_weights: not_trained_yet.json\n"),
      {.sea = "", .pea = folder_ / "pea.json"});
  EXPECT_FALSE(config.sea.has_value());
  EXPECT_EQ(config.pea->network, "pea");
  EXPECT_EQ(esn::LoadEsnConfig("", {.sea = folder_ / "sea.json", .pea = ""}).sea->network, "sea");
}

TEST_F(LearningConfig, EsnStandsInWithInverseDynamics) {
  const esn::EsnConfig config = esn::LoadEsnConfig(
      Write("schema: sinew-esn-participant/1\nmode: inverse_dynamics\n" + kModel));
  EXPECT_EQ(config.mode, esn::EsnConfig::Mode::kInverseDynamics);
  EXPECT_EQ(config.inverse_dynamics.robot.joints.size(), 1u);
  EXPECT_EQ(config.inverse_dynamics.state, esn::MotionState::kReference);
  EXPECT_FALSE(config.inverse_dynamics.stance.has_value());
}

TEST_F(LearningConfig, EsnStandsInWithABipedOnBothSoles) {
  const std::string head = "schema: sinew-esn-participant/1\nmode: inverse_dynamics\n" + kModel;
  const std::string urdf = std::string(SINEW_SOURCE_DIR) + "/robots/biped/biped.urdf";
  const esn::EsnConfig config = esn::LoadEsnConfig(
      Write(head + "stance: double\nurdf: " + urdf +
            "\nstate: measured\nfeedback: {proportional_1_s2: 100, derivative_1_s: 20}\n"));
  const esn::InverseDynamicsConfig& inverse = config.inverse_dynamics;
  ASSERT_TRUE(inverse.stance.has_value());
  EXPECT_EQ(inverse.stance->chain.name, "biped");
  EXPECT_EQ(inverse.state, esn::MotionState::kMeasured);
  EXPECT_EQ(inverse.proportional_1_s2, 100.0);
  EXPECT_EQ(inverse.derivative_1_s, 20.0);
  const auto message = [&](const std::string& text) {
    return MessageOf([&] { esn::LoadEsnConfig(Write(head + text)); });
  };
  EXPECT_THAT(message("stance: double\n"), HasSubstr("urdf"));
  EXPECT_THAT(message("stance: single\n"), HasSubstr("key 'stance'"));
  EXPECT_THAT(message("urdf: " + urdf + "\n"), HasSubstr("urdf"));
  EXPECT_THAT(message("state: guessed\n"), HasSubstr("key 'state'"));
  EXPECT_THAT(message("feedback: {proportional_1_s2: -1}\n"), HasSubstr("proportional_1_s2"));
  EXPECT_THAT(message("feedback: {gain: 1}\n"), HasSubstr("gain"));
}

TEST_F(LearningConfig, EsnNamesEveryMistake) {
  const auto message = [&](const std::string& text) {
    return MessageOf(
        [&] { esn::LoadEsnConfig(Write("schema: sinew-esn-participant/1\n" + text)); });
  };
  const std::string file = (folder_ / "c.yaml").string();
  EXPECT_THAT(MessageOf([] { esn::LoadEsnConfig(""); }), StartsWith("--config: missing"));
  EXPECT_THAT(message("mode: network\n"),
              StartsWith(file + ":2: key 'mode': network, expected sea_weights"));
  EXPECT_THAT(message("mode: guess\n"), StartsWith(file + ":2: key 'mode'"));
  EXPECT_THAT(message("pea_weights: nothing.json\n"), HasSubstr("nothing.json"));
  EXPECT_THAT(message("pea_weights: pea.json\nadaption: true\n"), StartsWith(file + ":3: "));
  EXPECT_THAT(message("mode: inverse_dynamics\n" + kModel + "smoothing_rad_s: -1\n"),
              StartsWith(file + ":4: "));
  EXPECT_THAT(message("pea_weights: c.yaml\n"), HasSubstr("no valid JSON"));
}

TEST_F(LearningConfig, RlsReadsItsFigures) {
  const rls::RlsConfig config = rls::LoadRlsConfig(
      Write("schema: sinew-rls-participant/1\npea_weights: pea.json\n" + kModel +
            "torque_from: command\ncarry_over: false\nforgetting: 0.995\nprior_precision: "
            "0.1\nclip_sigmas: 0\ninitial_innovation_Nm: 0.2\n"
            "slowest_velocity_rad_s: 0.1\nstill_after_s: 0.5\n"));
  EXPECT_EQ(config.torque_from, rls::TorqueFrom::kCommand);
  EXPECT_FALSE(config.target.carry_over);
  EXPECT_EQ(config.adapter.rls.forgetting, 0.995);
  EXPECT_EQ(config.adapter.rls.prior_precision, 0.1);
  EXPECT_EQ(config.adapter.rls.clip_sigmas, 0.0);
  EXPECT_EQ(config.adapter.rls.initial_innovation, 0.2);
  EXPECT_EQ(config.adapter.slowest_velocity_rad_s, 0.1);
  EXPECT_EQ(config.adapter.still_after_s, 0.5);
  EXPECT_FALSE(config.sea.has_value());
}

TEST_F(LearningConfig, RlsTakesTheBodiesOfABiped) {
  const std::string head = "schema: sinew-rls-participant/1\npea_weights: pea.json\n" + kModel;
  EXPECT_FALSE(rls::LoadRlsConfig(Write(head)).target.stance.has_value());
  const rls::RlsConfig config = rls::LoadRlsConfig(
      Write(head + "stance: double\nurdf: " SINEW_SOURCE_DIR "/robots/biped/biped.urdf\n"));
  ASSERT_TRUE(config.target.stance.has_value());
  EXPECT_EQ(config.target.stance->chain.name, "biped");
}

TEST_F(LearningConfig, RlsNamesEveryMistake) {
  const auto message = [&](const std::string& text) {
    return MessageOf(
        [&] { rls::LoadRlsConfig(Write("schema: sinew-rls-participant/1\n" + text)); });
  };
  const std::string file = (folder_ / "c.yaml").string();
  EXPECT_THAT(MessageOf([] { rls::LoadRlsConfig(""); }), StartsWith("--config: missing"));
  EXPECT_THAT(message(kModel), HasSubstr("expected sea_weights or pea_weights"));
  EXPECT_THAT(message("pea_weights: pea.json\n"), HasSubstr("'model'"));
  EXPECT_THAT(message("pea_weights: pea.json\n" + kModel + "forgetting: 1.2\n"),
              StartsWith(file + ":4: "));
  EXPECT_THAT(message("pea_weights: pea.json\n" + kModel + "forgetting: .nan\n"),
              StartsWith(file + ":4: "));
  EXPECT_THAT(message("pea_weights: pea.json\n" + kModel + "forget: 0.9\n"),
              StartsWith(file + ":4: "));
  EXPECT_THAT(message("pea_weights: load.json\n" + kModel), HasSubstr("target 'load_torque_Nm'"));
}

}  // namespace
}  // namespace sinew
