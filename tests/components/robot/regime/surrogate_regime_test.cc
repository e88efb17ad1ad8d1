// The detector on the surrogate's sensors, assessed by the surrogate's truth about its teeth.
//
// Counted as wrong: every sample that is not right, except within one sample of a true transition
// or of the play's opening to two encoder counts, whichever is later.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "components/base/types/control_mode.h"
#include "components/base/types/regime.h"
#include "components/robot/regime/detector.h"
#include "sim/surrogate/rig.h"
#include "tests/support/rig_constants.h"

namespace sinew::regime {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

struct Score {
  long samples = 0, wrong = 0, transitions = 0, flips = 0, unknown = 0;
  double wrong_share() const { return static_cast<double>(wrong) / static_cast<double>(samples); }
};

// drive(time) gives the command and the hand's force.
template <class DriveFunction>
Score Assess(surrogate::RigParameters parameters, double seconds, const DriveFunction& drive) {
  surrogate::Rig rig(parameters);
  DetectorConfig config;
  config.play.backlash_rad = parameters.gear.play_rad;
  config.play.output_noise_rad = parameters.sensors.output_encoder_noise_rad;
  config.gear_ratio = parameters.gear.ratio;
  RegimeDetector detector(config);
  std::vector<Contact> truth, found;
  std::vector<double> open_rad;
  Score score;
  for (int k = 0; k < static_cast<int>(seconds / kPeriod_s); ++k) {
    rig.Advance(drive(k * kPeriod_s), kPeriod_s);
    const surrogate::RigReading reading = rig.Read();
    const surrogate::RigTruth real = rig.truth();
    DetectorInput input;
    input.session_id = 1;
    input.period_s = kPeriod_s;
    input.valid = true;
    input.motor_position_rad = reading.motor_angle_rad;
    input.output_position_rad = reading.output_angle_rad;
    input.output_velocity_rad_s = reading.output_velocity_rad_s;
    const DetectorOutput out = detector.Step(input);
    score.unknown += out.regime == types::Regime::kUnknown;
    truth.push_back(real.contact == 0  ? Contact::kNone
                    : real.contact > 0 ? Contact::kUpper
                                       : Contact::kLower);
    found.push_back(out.contact);
    const double gap_rad = real.motor_angle_rad / parameters.gear.ratio - real.output_angle_rad;
    open_rad.push_back(0.5 * parameters.gear.play_rad - std::abs(gap_rad));
  }
  score.samples = static_cast<long>(truth.size());
  for (std::size_t k = 1; k + 1 < truth.size(); ++k) {
    score.transitions += truth[k] != truth[k - 1];
    score.flips += found[k] != found[k - 1];
    const bool at_transition =
        truth[k] != truth[k - 1] || truth[k] != truth[k + 1] || (k > 1 && truth[k] != truth[k - 2]);
    const bool hardly_open =
        truth[k] == Contact::kNone && std::min(open_rad[k], open_rad[k - 1]) < 2.0 * kCount_rad;
    score.wrong += !at_transition && !hardly_open && found[k] != truth[k];
  }
  return score;
}

void ExpectRight(const Score& score, const std::string& where) {
  EXPECT_LE(score.wrong_share(), 0.005)
      << where << ": " << score.wrong << " of " << score.samples << ", " << score.flips
      << " changes found, " << score.transitions << " true";
  EXPECT_EQ(score.unknown, 0) << where;
  // Bounces of the teeth shorter than a sample may be missed, but none may be made up.
  EXPECT_LE(score.flips, score.transitions + 2) << where << ": chatters";
}

TEST(RegimeOnSurrogate, InsideTheBacklashWithTheHand) {
  for (const double pressure_bar : {2.0, 4.0, 6.0}) {
    surrogate::RigParameters parameters;
    parameters.pneumatics.initial_pressure_bar = pressure_bar;
    parameters.rotor_locked = true;
    const Score score = Assess(parameters, 15.0, [&](double time_s) {
      surrogate::RigInput input;
      const double push = std::sin(2.0 * std::numbers::pi * 2.0 * time_s);
      input.hand_force_N = push > 0.0 ? 14.0 * push : 0.0;
      return input;
    });
    ExpectRight(score, std::to_string(pressure_bar) + " bar");
    EXPECT_GT(score.transitions, 10);
  }
}

TEST(RegimeOnSurrogate, MotorTurningToAndFroAtEverySpeed) {
  for (const double speed_rad_s : {0.002, 0.01, 0.05, 1.0}) {
    for (const double pressure_bar : {1.0, 4.0}) {
      surrogate::RigParameters parameters;
      parameters.pneumatics.initial_pressure_bar = pressure_bar;
      const double stroke_rad = speed_rad_s < 0.02 ? 0.03 : 0.3;
      const double period_s = 4.0 * stroke_rad / speed_rad_s;
      const Score score =
          Assess(parameters, std::clamp(1.5 * period_s, 15.0, 30.0), [&](double time_s) {
            surrogate::RigInput input;
            const double u = std::fmod(time_s / period_s + 0.25, 1.0);
            const double way = u < 0.5 ? 4.0 * u - 1.0 : 3.0 - 4.0 * u;
            input.drive.mode = types::ControlMode::kPosition;
            input.drive.position_rad = parameters.gear.ratio * stroke_rad * way;
            // Load through the play: from the hand's side to the chamber's and back.
            input.hand_force_N = 8.0 * std::sin(2.0 * std::numbers::pi * 0.37 * time_s);
            return input;
          });
      ExpectRight(score, std::to_string(speed_rad_s) + " rad/s at " + std::to_string(pressure_bar) +
                             " bar");
    }
  }
}

}  // namespace
}  // namespace sinew::regime
