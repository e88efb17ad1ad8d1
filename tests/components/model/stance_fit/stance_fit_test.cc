// Squats of robots/biped in the simulated world, with what its model does not declare. Recordings
// of one motion differ by the seed of the sensors' noise. The results are printed: the README of
// components/model/stance_fit has them.
#include "components/model/stance_fit/stance_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "tests/components/model/stance_fit/squat_recording.h"

namespace sinew::stance_fit {
namespace {

const StanceModel& Model() {
  static const StanceModel model(ReadRobot(), DeclaredRobot(ReadRobot()));
  return model;
}

constexpr SquatPlan kTrain = {.cycles = 4, .period_s = 2.4, .top_m = 0.06, .bottom_m = 0.26};
constexpr SquatPlan kHeldOut = {.cycles = 3, .period_s = 2.8, .top_m = 0.08, .bottom_m = 0.24};

struct Pair {
  Motion train, held_out;
};

// A motion is simulated once.
const Pair& Moved(const std::string& key, const Undeclared& undeclared) {
  static std::map<std::string, Pair> known;
  const auto at = known.find(key);
  if (at != known.end()) return at->second;
  return known[key] = {Squat(undeclared, kTrain), Squat(undeclared, kHeldOut)};
}

StanceFitResult Close(const Pair& motion, unsigned seed, const SensorNoise& noise = {}) {
  return FitStance(Model(), {Recorded(motion.train, "train", seed, noise)},
                   {Recorded(motion.held_out, "held_out", seed + 1000, noise)});
}

std::string Summary(const StanceFitResult& result) {
  std::ostringstream out;
  out << "verdict " << static_cast<int>(result.verdict) << " " << result.too_little << " p "
      << result.p_global.value_or(-1.0) << " rows " << result.rows << " channels "
      << result.channels << " blocks " << result.blocks << " low-pass " << result.low_pass_Hz
      << " unexplained '" << result.unexplained << "'\n";
  const auto effects = [&](const char* what, const std::vector<StanceEffect>& list) {
    for (const StanceEffect& effect : list) {
      out << "  " << what << " " << effect.name << " of " << effect.place << " p " << effect.p
          << " share " << effect.gain_share << " slope " << effect.confirmation.slope << " ["
          << effect.confirmation.lower << ", " << effect.confirmation.upper << "] in model "
          << effect.in_model;
      if (effect.payload) {
        out << " mass " << effect.payload->mass_kg << " +- " << effect.payload->mass_half_width_95
            << " place " << effect.payload->place_m.transpose() << " +- "
            << effect.payload->place_half_width_95.transpose();
      }
      if (effect.term) {
        for (const actuator::ParameterValue& value : effect.term->linear) {
          out << " value " << value.value << " +- " << value.half_width_95.value_or(0.0);
        }
      }
      for (const trace::NameProbability& name : effect.posterior) {
        out << " {" << name.name << " " << name.probability << "}";
      }
      out << "\n";
    }
  };
  effects("effect", result.effects);
  effects("refuted", result.refuted);
  const auto error = [&](const char* name, const StanceError& e) {
    out << "  " << name << " mx " << e.moment_x_Nm << " my " << e.moment_y_Nm << " fz "
        << e.force_z_N << " share " << e.share << "\n";
  };
  error("train before", result.train_before);
  error("train after", result.train_after);
  error("held-out before", result.held_out_before);
  error("held-out after", result.held_out_after);
  for (const trace::NotExcited& entry : result.not_excited) {
    out << "  not excited: " << entry.effect << ": " << entry.reason << "\n";
  }
  return out.str();
}

const StanceEffect* Only(const StanceFitResult& result) {
  return result.effects.size() == 1 ? &result.effects.front() : nullptr;
}

// 4 kg in the frame of the base, named within 5 % and horizontally within 20 mm.
void ExpectPayload(const StanceFitResult& result, const Eigen::Vector3d& place_m) {
  std::cout << Summary(result);
  const StanceEffect* effect = Only(result);
  ASSERT_NE(effect, nullptr);
  EXPECT_EQ(result.verdict, trace::Verdict::kEffect);
  EXPECT_EQ(effect->name, "payload");
  EXPECT_EQ(effect->place, "base");
  ASSERT_TRUE(effect->payload.has_value());
  EXPECT_NEAR(effect->payload->mass_kg, 4.0, 0.05 * 4.0);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    EXPECT_TRUE(effect->payload->excited[static_cast<std::size_t>(axis)]);
    EXPECT_NEAR(effect->payload->place_m[axis], place_m[axis], 0.02);
  }
  EXPECT_TRUE(effect->in_model);
  EXPECT_LT(result.held_out_after.force_z_N, 0.5 * result.held_out_before.force_z_N);
}

bool NotExcited(const StanceFitResult& result, const std::string& effect) {
  return std::any_of(result.not_excited.begin(), result.not_excited.end(),
                     [&](const trace::NotExcited& entry) { return entry.effect == effect; });
}

TEST(FitStance, NamesAPayloadOnTheTorsoAndReportsThatItsHeightIsNotExcited) {
  const Eigen::Vector3d place(0.03, 0.02, 0.2);
  const Pair& motion = Moved("torso", {.payload_kg = 4.0, .place_m = place});
  for (const unsigned seed : {11u, 12u}) {
    const StanceFitResult result = Close(motion, seed);
    ExpectPayload(result, place);
    EXPECT_TRUE(NotExcited(result, "place of the payload along z of base"));
  }
}

void ExpectFriction(const StanceFitResult& result, const std::string& type, double size) {
  std::cout << Summary(result);
  const auto effect = std::find_if(
      result.effects.begin(), result.effects.end(),
      [&](const StanceEffect& one) { return one.name == type && one.place == "left_ankle_pitch"; });
  ASSERT_NE(effect, result.effects.end());
  EXPECT_EQ(result.verdict, trace::Verdict::kEffect);
  for (const StanceEffect& other : result.effects) EXPECT_LE(other.gain_share, effect->gain_share);
  ASSERT_TRUE(effect->term.has_value());
  EXPECT_NEAR(effect->term->linear[0].value, size, 0.2 * size);
  EXPECT_TRUE(effect->in_model);
  EXPECT_LT(result.held_out_after.share, result.held_out_before.share);
}

TEST(FitStance, NamesCoulombFrictionOfAnAnkle) {
  const Pair& motion = Moved("coulomb", {.friction_joint = "left_ankle_pitch", .coulomb_Nm = 1.5});
  for (const unsigned seed : {14u, 15u}) ExpectFriction(Close(motion, seed), "coulomb", 1.5);
}

TEST(FitStance, NamesViscousFrictionOfAnAnkle) {
  const Pair& motion =
      Moved("viscous", {.friction_joint = "left_ankle_pitch", .viscous_Nm_s_rad = 3.0});
  for (const unsigned seed : {16u, 17u}) ExpectFriction(Close(motion, seed), "viscous", 3.0);
}

TEST(FitStance, NamesNothingWhereEverythingIsDeclared) {
  for (const unsigned seed : {18u, 19u}) {
    const StanceFitResult result = Close(Moved("clean", {}), seed);
    std::cout << Summary(result);
    EXPECT_EQ(result.verdict, trace::Verdict::kNone);
    EXPECT_TRUE(result.effects.empty());
    EXPECT_FALSE(NotExcited(result, "friction of left_ankle_pitch"));
    EXPECT_TRUE(NotExcited(result, "friction of left_hip_yaw"));
  }
}

// What a robot that stands still shows: that it weighs more, but not whether its joints rub. Force
// sensors that all read too much are as probable as a payload then.
TEST(FitStance, CannotShowFrictionOfARobotThatStandsStill) {
  constexpr SquatPlan kStill = {
      .cycles = 1, .period_s = 6.0, .top_m = 0.15, .bottom_m = 0.15, .settle_s = 8.0};
  const Pair still = {Squat({.payload_kg = 4.0, .place_m = {0.03, 0.0, 0.2}}, kStill),
                      Squat({.payload_kg = 4.0, .place_m = {0.03, 0.0, 0.2}}, kStill)};
  const StanceFitResult result = Close(still, 20);
  std::cout << Summary(result);
  for (const std::string& joint : still.train.joints) {
    EXPECT_TRUE(NotExcited(result, "friction of " + joint)) << joint;
  }
  ASSERT_EQ(result.effects.size(), 1u);
  double payload = 0.0, gain = 0.0;
  for (const trace::NameProbability& name : result.effects.front().posterior) {
    if (name.name == "payload of base") payload = name.probability;
    if (name.name == "load_cell_gain of the feet") gain = name.probability;
  }
  EXPECT_GT(payload, 0.3);
  EXPECT_GT(payload + gain, 0.9);
}

TEST(StanceModel, RefusesLinksThatAreNotThere) {
  StanceConfig config;
  config.imu_link = "gyroscope";
  EXPECT_THROW(StanceModel(ReadRobot(), DeclaredRobot(ReadRobot()), config), std::invalid_argument);
  config = {};
  std::swap(config.force_links[0], config.force_links[7]);
  EXPECT_THROW(StanceModel(ReadRobot(), DeclaredRobot(ReadRobot()), config), std::invalid_argument);
}

TEST(StanceModel, RefusesForcesThatAreNotFinite) {
  StanceRecording recording = Recorded(
      Squat({}, {.cycles = 1, .period_s = 1.0, .top_m = 0.1, .bottom_m = 0.1}), "short", 1);
  recording.foot_force_N(3, 2) = std::nan("");
  EXPECT_THROW(Model().Layout({recording}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::stance_fit
