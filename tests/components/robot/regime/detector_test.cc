// Oracle: a link held by friction and a chamber, moved through rigid teeth, so that the contact is
// known exactly.
#include "components/robot/regime/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "components/base/types/regime.h"
#include "tests/support/allocations.h"
#include "tests/support/rig_constants.h"

namespace sinew::regime {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;
constexpr double kBacklash_rad = 0.0464258;
constexpr double kN = 100.0;

DetectorConfig Active() {
  DetectorConfig config;
  config.play.backlash_rad = kBacklash_rad;
  config.gear_ratio = kN;
  config.setup = Setup::kActive;
  return config;
}

// Teeth push the link along; else it stays, or the chamber takes it to the contact it presses on.
struct Rig {
  double middle_rad =
      0.123;               // motor / N - output in the middle of the play: unknown to the detector
  double motor_rad = 0.0;  // at the output
  double link_rad = -0.12;
  double pressure_bar = 0.0;
  double chamber_rad_s = 0.0;  // the chamber moves a free link at this speed; sign: direction
  bool rigid = true;
  std::mt19937_64 random{9};
  std::normal_distribution<double> noise{0.0, 1.5e-4};

  void Step(const DetectorOutput& out, double velocity_rad_s) {
    if (out.request != types::Motion::kNone) {
      pressure_bar += std::clamp(out.request_pressure_bar - pressure_bar, -0.02, 0.02);
    }
    if (out.request == types::Motion::kPushAgainstChamber) {
      const double step = velocity_rad_s * kPeriod_s;
      motor_rad += std::clamp(out.request_target_rad - motor_rad, -step, step);
    }
    if (pressure_bar > 1.0) link_rad += chamber_rad_s * kPeriod_s;
    if (!rigid) return;
    const double gap = motor_rad - link_rad - middle_rad;
    if (gap > 0.5 * kBacklash_rad) link_rad += gap - 0.5 * kBacklash_rad;
    if (gap < -0.5 * kBacklash_rad) link_rad += gap + 0.5 * kBacklash_rad;
  }

  DetectorInput Read(bool armed) {
    DetectorInput input;
    input.session_id = 3;
    input.period_s = kPeriod_s;
    input.armed = armed;
    input.valid = true;
    input.motor_position_rad = kN * motor_rad;
    input.output_position_rad = kCount_rad * std::round((link_rad + noise(random)) / kCount_rad);
    input.pressure_bar = pressure_bar;
    return input;
  }
};

TEST(RegimeDetector, IsUnknownWithoutSetupAndAsksForNothingWhileDisarmed) {
  RegimeDetector detector(Active());
  Rig rig;
  for (int k = 0; k < 1000; ++k) {
    const DetectorOutput out = detector.Step(rig.Read(false));
    EXPECT_EQ(out.regime, types::Regime::kUnknown);
    EXPECT_EQ(out.phase, Phase::kWaiting);
    EXPECT_EQ(out.request, types::Motion::kNone);
    EXPECT_EQ(out.confidence, 0.0);
  }
}

TEST(RegimeDetector, ActiveSetupFindsTheContactWhereverTheLinkStands) {
  for (const double direction : {1.0, -1.0}) {
    for (const double place : {-0.45, -0.2, 0.0, 0.3, 0.49}) {
      DetectorConfig config = Active();
      config.chamber_direction = direction;
      RegimeDetector detector(config);
      Rig rig;
      rig.link_rad = rig.motor_rad - rig.middle_rad + place * kBacklash_rad;
      DetectorOutput out;
      int ticks = 0;
      for (; ticks < 20 * 240 && !detector.setup_done(); ++ticks) {
        out = detector.Step(rig.Read(true));
        EXPECT_TRUE(detector.setup_done() || out.regime == types::Regime::kUnknown);
        rig.Step(out, config.velocity_rad_s);
      }
      ASSERT_TRUE(detector.setup_done()) << place << ' ' << TroubleText(out.trouble);
      // Mean over the contact's rigid motion; the teeth have touched for all of it but the first
      // samples.
      EXPECT_NEAR(detector.offset_rad(), rig.middle_rad - 0.5 * kBacklash_rad, kCount_rad)
          << place << " direction " << direction;
      EXPECT_EQ(out.regime, types::Regime::kPea);
      EXPECT_EQ(out.contact, direction > 0 ? Contact::kLower : Contact::kUpper);
      EXPECT_EQ(out.phase, Phase::kExecution);
      EXPECT_EQ(out.request, types::Motion::kNone);
      EXPECT_GT(out.confidence, 0.5);
    }
  }
}

TEST(RegimeDetector, TheChamberMovingTheLinkIsNoContact) {
  RegimeDetector detector(Active());
  Rig rig;
  rig.chamber_rad_s = 0.02;  // up, against the motor that comes down
  DetectorOutput out;
  for (int k = 0; k < 20 * 240 && !detector.setup_done(); ++k) {
    out = detector.Step(rig.Read(true));
    rig.Step(out, 0.05);
  }
  ASSERT_TRUE(detector.setup_done());
  EXPECT_NEAR(detector.offset_rad(), rig.middle_rad - 0.5 * kBacklash_rad, kCount_rad);
}

TEST(RegimeDetector, WithoutPressureItGivesUpAndSaysWhy) {
  RegimeDetector detector(Active());
  Rig rig;
  DetectorOutput out;
  for (int k = 0; k < 25 * 240; ++k) {
    out = detector.Step(rig.Read(true));  // nobody fills the chamber
    EXPECT_NE(out.request, types::Motion::kPushAgainstChamber);
  }
  EXPECT_EQ(out.trouble, Trouble::kNoPressure);
  EXPECT_EQ(out.regime, types::Regime::kUnknown);
  EXPECT_EQ(out.request, types::Motion::kNone) << "not again by itself";
  static_cast<void>(detector.Step(rig.Read(false)));
  EXPECT_EQ(detector.Step(rig.Read(true)).phase, Phase::kSetup) << "but when armed again";
}

TEST(RegimeDetector, AnOutputThatDoesNotFollowIsNoContact) {
  RegimeDetector detector(Active());
  Rig rig;
  rig.rigid = false;  // a broken tooth: the motor turns alone
  DetectorOutput out;
  for (int k = 0; k < 25 * 240; ++k) {
    out = detector.Step(rig.Read(true));
    rig.Step(out, 0.05);
  }
  EXPECT_EQ(out.trouble, Trouble::kNoContact);
  EXPECT_EQ(out.regime, types::Regime::kUnknown);
}

TEST(RegimeDetector, AGivenSetupWorksFromTheFirstSample) {
  DetectorConfig config = Active();
  config.setup = Setup::kGiven;
  config.play_center_rad = 0.123;
  RegimeDetector detector(config);
  Rig rig;
  rig.link_rad = -0.123;
  DetectorOutput out = detector.Step(rig.Read(false));
  EXPECT_EQ(out.regime, types::Regime::kSea);
  EXPECT_NEAR(out.alpha_rad, 0.5 * kBacklash_rad, 3.0 * kCount_rad);
  rig.link_rad = -0.123 - 0.5 * kBacklash_rad;  // motor ahead: it pushes the link up
  for (int k = 0; k < 5; ++k) out = detector.Step(rig.Read(false));
  EXPECT_EQ(out.contact, Contact::kUpper);
  EXPECT_EQ(out.regime, types::Regime::kPea);
}

TEST(RegimeDetector, ASlippedEncoderOrWrongSetupIsUnknownNotGuessed) {
  DetectorConfig config = Active();
  config.setup = Setup::kGiven;
  config.play_center_rad = 0.123;
  RegimeDetector detector(config);
  Rig rig;
  rig.link_rad = -0.123;
  EXPECT_EQ(detector.Step(rig.Read(true)).regime, types::Regime::kSea);
  rig.link_rad -= 0.5 * kBacklash_rad + 0.02;  // the magnet slipped
  DetectorOutput out;
  for (int k = 0; k < 3; ++k) out = detector.Step(rig.Read(true));
  EXPECT_EQ(out.trouble, Trouble::kInconsistent);
  EXPECT_EQ(out.regime, types::Regime::kUnknown);
  rig.link_rad = -0.123;  // being back inside proves nothing
  EXPECT_EQ(detector.Step(rig.Read(true)).regime, types::Regime::kUnknown);
  DetectorInput other = rig.Read(true);
  other.session_id = 4;
  EXPECT_EQ(detector.Step(other).regime, types::Regime::kSea);
}

TEST(RegimeDetector, LostOrBadSamplesAreUnknown) {
  DetectorConfig config = Active();
  config.setup = Setup::kGiven;
  RegimeDetector detector(config);
  Rig rig;
  rig.middle_rad = 0.0;
  rig.link_rad = 0.0;
  DetectorInput input = rig.Read(true);
  input.valid = false;
  EXPECT_EQ(detector.Step(input).regime, types::Regime::kUnknown);
  for (double DetectorInput::*field :
       {&DetectorInput::motor_position_rad, &DetectorInput::output_position_rad,
        &DetectorInput::output_velocity_rad_s}) {
    input = rig.Read(true);
    input.*field = std::nan("");
    const DetectorOutput out = detector.Step(input);
    EXPECT_EQ(out.regime, types::Regime::kUnknown);
    EXPECT_EQ(out.trouble, Trouble::kBadInput);
  }
  EXPECT_EQ(detector.Step(rig.Read(true)).regime, types::Regime::kSea);
}

TEST(RegimeDetector, AMillionStepsAllocateNothing) {
  RegimeDetector detector(Active());
  Rig rig;
  const long before = test::Allocations();
  DetectorOutput out;
  for (int k = 0; k < 1000000; ++k) {
    out = detector.Step(rig.Read(true));
    rig.Step(out, 0.05);
    if (detector.setup_done()) rig.motor_rad = 0.1 * std::sin(1e-3 * k);
    rig.Step(DetectorOutput{}, 0.0);
    ASSERT_NE(out.trouble, Trouble::kInconsistent) << k;
  }
  EXPECT_EQ(test::Allocations() - before, 0);
}

TEST(RegimeDetector, BadConfigurationIsRefused) {
  DetectorConfig config = Active();
  config.gear_ratio = 0.0;
  EXPECT_THROW(RegimeDetector{config}, std::invalid_argument);
  config = Active();
  config.chamber_direction = 0.5;
  EXPECT_THROW(RegimeDetector{config}, std::invalid_argument);
  config = Active();
  config.min_pressure_bar = 5.0;
  EXPECT_THROW(RegimeDetector{config}, std::invalid_argument);
  config = Active();
  config.travel_rad = 0.05;
  EXPECT_THROW(RegimeDetector{config}, std::invalid_argument);
}

TEST(RegimeDetector, AStandbyTakesTheContactThatTheOwnerFound) {
  RegimeDetector standby(Active());
  Rig rig;
  DetectorInput input = rig.Read(false);
  ASSERT_EQ(standby.Step(input).phase, Phase::kWaiting);
  const double offset_rad = rig.middle_rad - 0.5 * kBacklash_rad;
  standby.Adopt(input.session_id, offset_rad);
  const DetectorOutput out = standby.Step(rig.Read(true));
  EXPECT_EQ(out.phase, Phase::kExecution);
  EXPECT_EQ(out.request, types::Motion::kNone) << "there is nothing left to find";
  EXPECT_EQ(standby.offset_rad(), offset_rad);
  EXPECT_GT(standby.offset_error_rad(), 0.0);
  standby.Adopt(input.session_id, offset_rad + 0.01);
  EXPECT_EQ(standby.offset_rad(), offset_rad) << "it has one already";
  standby.Adopt(input.session_id + 1, std::nan(""));
  EXPECT_TRUE(standby.setup_done()) << "no number, no session";
}

}  // namespace
}  // namespace sinew::regime
