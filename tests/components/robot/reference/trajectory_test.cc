// Oracles: central finite differences of the position, closed forms, and (5.6)-(5.10) written out
// again.
#include "components/robot/reference/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/robot/reference/limits.h"

namespace sinew::reference {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<std::pair<std::string, TrajectoryPtr>> SmoothTrajectories() {
  std::vector<double> t, q;
  for (int i = 0; i <= 200; ++i) {
    t.push_back(3.0 + 0.05 * i);
    q.push_back(0.4 * std::sin(1.3 * t.back()) + 0.1 * std::cos(2.9 * t.back()));
  }
  ChirpConfig chirp{.center_rad = 0.2, .amplitude_rad = 0.6};
  chirp.lower_amplitude = 3.0;  // so that both bounds breathe
  const auto multisine = std::make_shared<Multisine>(MultisineConfig{.center_rad = 0.1,
                                                                     .amplitude_rad = 0.4,
                                                                     .lowest_frequency_Hz = 0.1,
                                                                     .highest_frequency_Hz = 2.0});
  const MoveConfig there{
      .from_rad = 0.1, .to_rad = -0.7, .speed_rad_s = 0.3, .acceleration_rad_s2 = 1.0};
  const MoveConfig back{
      .from_rad = -0.7, .to_rad = -0.69, .speed_rad_s = 0.3, .acceleration_rad_s2 = 1.0};
  const auto sequence = std::make_shared<Sequence>(std::vector<TrajectoryPtr>{
      std::make_shared<Windowed>(multisine, 0.1, 6.0, 1.0), std::make_shared<Move>(there),
      std::make_shared<Hold>(-0.7, 0.5), std::make_shared<Move>(back)});
  return {{"sine", std::make_shared<Sine>(SineConfig{0.1, 0.5, 0.4, 0.3})},
          {"chirp", std::make_shared<Chirp>(chirp)},
          {"step", std::make_shared<Step>(StepConfig{
                       .from_rad = 0.1, .to_rad = 0.8, .step_at_s = 1.0, .rise_s = 0.7})},
          {"multisine", multisine},
          {"move", std::make_shared<Move>(there)},
          {"samples", std::make_shared<Samples>(t, q)},
          {"sequence", sequence},
          {"scaled", std::make_shared<Scaled>(multisine, 0.1, 0.25)}};
}

TEST(Trajectory, VelocityAndAccelerationAreDerivativesOfPosition) {
  constexpr double kStep_s = 1e-4;
  // Truncation h^2/6 x''' with |x'''| < 1e3 here, and rounding 1e-16/h.
  constexpr double kTolerance = 1e-5;
  for (const auto& [name, trajectory] : SmoothTrajectories()) {
    const double end_s = std::isfinite(trajectory->duration_s()) ? trajectory->duration_s() : 30.0;
    for (double t = 0.00137; t < end_s + 1.0; t += 0.0371) {
      const Point p = trajectory->At(t);
      const Point before = trajectory->At(t - kStep_s);
      const Point after = trajectory->At(t + kStep_s);
      EXPECT_NEAR(p.velocity_rad_s, (after.position_rad - before.position_rad) / (2 * kStep_s),
                  kTolerance)
          << name << " at " << t;
      // A corner of the acceleration (ends of a move's ramp) inside the interval costs at most jerk
      // * h.
      EXPECT_NEAR(p.acceleration_rad_s2,
                  (after.velocity_rad_s - before.velocity_rad_s) / (2 * kStep_s), 5e-3)
          << name << " at " << t;
    }
  }
}

TEST(Chirp, EqualsThePublishedEquationsAtEverySample) {
  ChirpConfig config;
  config.amplitude_rad = 4.0;  // |y| peaks at 4: position = y
  const Chirp chirp(config);
  const double T = 200.0, f0 = 0.15, f1 = 1.5;
  const int N = 48000;
  double largest = 0.0;
  for (int n = 0; n < N; ++n) {
    const double t = n * T / N;                                                   // (5.6)
    const double x = std::cos(2 * kPi * (f0 * t + (f1 - f0) / (2 * T) * t * t));  // (5.7)
    const double a_max = 8.0 * std::sin(2 * kPi * 0.13 * t + kPi / 2);            // (5.8)
    const double a_min = 0.0 * std::sin(2 * kPi * 0.07 * t + kPi / 4);            // (5.9)
    const double y = (a_max - a_min) / 2 * x;                                     // (5.10)
    ASSERT_NEAR(chirp.At(t).position_rad, y, 1e-9) << "n = " << n;  // phase 1000 rad in double
    largest = std::max(largest, std::abs(y));
  }
  EXPECT_NEAR(largest, 4.0, 0.01);  // "+-4"
}

TEST(Chirp, SweepsFromTheFirstToTheLastFrequency) {
  ChirpConfig config;
  config.amplitude_rad = 1.0;
  config.upper_frequency_Hz = 0.0;  // constant amplitude: only x is left
  const Chirp chirp(config);
  const auto crossings = [&chirp](double from_s, double to_s) {
    int count = 0;
    for (double t = from_s; t < to_s; t += 1e-3) {
      count += (chirp.At(t).position_rad > 0) != (chirp.At(t + 1e-3).position_rad > 0);
    }
    return count;
  };
  EXPECT_EQ(crossings(0.0, 20.0), static_cast<int>(std::round(2 * (0.15 * 20 + 0.003375 * 400))));
  EXPECT_NEAR(crossings(180.0, 200.0) / 40.0, 1.4325, 0.05);
}

TEST(Sine, StartsAtItsPhaseAndRunsFourCyclesInTenSeconds) {
  const Sine sine({.amplitude_rad = kPi / 6, .frequency_Hz = 0.4, .duration_s = 10.0});
  EXPECT_DOUBLE_EQ(sine.At(0.0).position_rad, 0.0);
  EXPECT_NEAR(sine.At(0.625).position_rad, kPi / 6, 1e-15);
  EXPECT_NEAR(sine.At(10.0).position_rad, 0.0, 1e-14);
  EXPECT_NEAR(sine.At(0.0).velocity_rad_s, kPi / 6 * 0.8 * kPi, 1e-15);
}

TEST(Sine, WithoutAmplitudeRests) {
  const Sine sine({.center_rad = 0.3, .amplitude_rad = 0.0, .frequency_Hz = 1.0});
  for (double t = 0; t < 3; t += 0.1) {
    EXPECT_EQ(sine.At(t).position_rad, 0.3);
    EXPECT_EQ(sine.At(t).velocity_rad_s, 0.0);
    EXPECT_EQ(sine.At(t).acceleration_rad_s2, 0.0);
  }
}

TEST(Step, WithoutRiseTimeJumpsAndHasNoDerivatives) {
  const Step step({.from_rad = 0.1, .to_rad = 0.5, .step_at_s = 1.0});
  EXPECT_EQ(step.At(0.999).position_rad, 0.1);
  EXPECT_EQ(step.At(1.0).position_rad, 0.5);
  EXPECT_EQ(step.At(1.0).velocity_rad_s, 0.0);
}

TEST(Multisine, KeepsItsAmplitudeRepeatsAndHoldsExactlyItsLines) {
  const MultisineConfig config{.amplitude_rad = 0.4,
                               .lowest_frequency_Hz = 0.2,
                               .highest_frequency_Hz = 2.0,
                               .period_s = 10.0,
                               .seed = 7};
  const Multisine multisine(config);
  EXPECT_EQ(multisine.line_count(), 19);
  double peak = 0.0;
  for (double t = 0; t < 10; t += 1e-3) {
    peak = std::max(peak, std::abs(multisine.At(t).position_rad));
    ASSERT_NEAR(multisine.At(t).position_rad, multisine.At(t + 10.0).position_rad, 1e-12);
  }
  EXPECT_NEAR(peak, 0.4, 1e-3);  // peak found on a grid of 64 points per shortest period
  // Fourier sums on a uniform grid are exact: nothing between the lines.
  const int count = 1000;
  for (int k = 0; k <= 40; ++k) {
    double c = 0, s = 0;
    for (int i = 0; i < count; ++i) {
      const double q = multisine.At(10.0 * i / count).position_rad;
      c += q * std::cos(2 * kPi * k * i / count);
      s += q * std::sin(2 * kPi * k * i / count);
    }
    const double amplitude = 2.0 / count * std::hypot(c, s);
    if (k < 2 || k > 20) {
      EXPECT_LT(amplitude, 1e-12) << k;
    } else {
      EXPECT_GT(amplitude, 1e-3) << k;
    }
  }
}

TEST(Multisine, SameSeedSameTrajectoryOtherSeedAnother) {
  MultisineConfig config{.amplitude_rad = 0.4};
  const Multisine a(config), b(config);
  config.seed = 2;
  const Multisine c(config);
  EXPECT_EQ(a.At(1.234).position_rad, b.At(1.234).position_rad);
  EXPECT_NE(a.At(1.234).position_rad, c.At(1.234).position_rad);
}

TEST(Move, KeepsSpeedAndAccelerationAndArrives) {
  for (const double to : {2.0, 0.011, -3.0}) {
    const Move move(
        {.from_rad = 0.01, .to_rad = to, .speed_rad_s = 0.2, .acceleration_rad_s2 = 0.8});
    const Extremes e = Measure(move, 0.0);
    EXPECT_LE(e.velocity_rad_s, 0.2 * (1 + 1e-12));
    EXPECT_LE(e.acceleration_rad_s2, 0.8 * (1 + 1e-12));
    EXPECT_NEAR(move.At(move.duration_s()).position_rad, to, 1e-15);
    EXPECT_NEAR(move.At(0.5 * move.duration_s()).position_rad, 0.5 * (0.01 + to), 1e-12);
  }
  const Move nowhere({.from_rad = 0.3, .to_rad = 0.3});
  EXPECT_EQ(nowhere.duration_s(), 0.0);
  EXPECT_EQ(nowhere.At(0.0).position_rad, 0.3);
}

TEST(Move, StaysWhereItArrived) {
  const Move move(
      {.from_rad = 0.1, .to_rad = -0.5, .speed_rad_s = 0.2, .acceleration_rad_s2 = 0.8});
  for (const double after_s : {0.0, 0.001, 0.3, 1e6}) {
    const Point p = move.At(move.duration_s() + after_s);
    EXPECT_EQ(p.position_rad, -0.5) << after_s;
    EXPECT_EQ(p.velocity_rad_s, 0.0) << after_s;
    EXPECT_EQ(p.acceleration_rad_s2, 0.0) << after_s;
  }
}

TEST(Sequence, FollowsEachPieceInItsOwnTime) {
  const auto move = std::make_shared<Move>(
      MoveConfig{.from_rad = 0.2, .to_rad = 0.6, .speed_rad_s = 0.5, .acceleration_rad_s2 = 2.0});
  const Sequence sequence(std::vector<TrajectoryPtr>{std::make_shared<Hold>(0.2, 1.5), move,
                                                     std::make_shared<Hold>(0.6, 2.0)});
  for (const double t : {0.0, 0.7, 1.499}) EXPECT_EQ(sequence.At(t).position_rad, 0.2) << t;
  for (const double t : {0.1, 0.5 * move->duration_s()}) {
    EXPECT_NEAR(sequence.At(1.5 + t).position_rad, move->At(t).position_rad, 1e-12) << t;
    EXPECT_NEAR(sequence.At(1.5 + t).velocity_rad_s, move->At(t).velocity_rad_s, 1e-12) << t;
  }
  EXPECT_EQ(sequence.At(1.5 + move->duration_s() + 1.0).position_rad, 0.6);
}

TEST(Samples, PassThroughEverySampleAndFollowASmoothCurve) {
  std::vector<double> t, q;
  for (int i = 0; i <= 400; ++i) {
    t.push_back(0.025 * i + (i % 2 ? 0.004 : 0.0));  // not uniform
    q.push_back(std::sin(2.0 * t.back()));
  }
  const Samples samples(t, q);
  for (std::size_t i = 0; i < t.size(); ++i)
    EXPECT_NEAR(samples.At(t[i]).position_rad, q[i], 1e-14);
  // Spline error 5/384 h^4 |q''''| away from the ends, where the natural condition costs more.
  for (double s = 1.0; s < 9.0; s += 0.0137) {
    EXPECT_NEAR(samples.At(s).position_rad, std::sin(2.0 * s),
                5.0 / 384 * std::pow(0.03, 4) * 16 * 2);
    EXPECT_NEAR(samples.At(s).velocity_rad_s, 2.0 * std::cos(2.0 * s), 1e-4);
  }
}

TEST(Scaled, FittingFactorKeepsEveryLimitAndReachesOne) {
  const auto sine = std::make_shared<Sine>(SineConfig{0.2, 1.0, 0.5, 0.0});
  const double omega = kPi;
  const struct {
    Limits limits;
    double factor;
  } kCases[] = {{{}, 1.0},
                {{.position_upper_rad = 0.7}, 0.5},
                {{.position_lower_rad = -0.05}, 0.25},
                {{.velocity_rad_s = omega / 10}, 0.1},
                {{.acceleration_rad_s2 = omega * omega / 4}, 0.25}};
  for (const auto& c : kCases) {
    EXPECT_NEAR(FittingFactor(Measure(*sine, 2.0), 0.2, c.limits), c.factor, 1e-6);
  }
  EXPECT_THROW(
      static_cast<void>(FittingFactor(Measure(*sine, 2.0), 0.2, {.position_upper_rad = 0.1})),
      std::invalid_argument);
}

TEST(Trajectory, BadConfigurationIsRefused) {
  const double nan = std::nan("");
  EXPECT_THROW(Hold{nan}, std::invalid_argument);
  EXPECT_THROW(Hold(0.0, -1.0), std::invalid_argument);
  EXPECT_THROW(Sine({.amplitude_rad = nan, .frequency_Hz = 1.0}), std::invalid_argument);
  EXPECT_THROW(Sine({.amplitude_rad = 1.0, .frequency_Hz = 0.0}), std::invalid_argument);
  EXPECT_THROW(Chirp({.duration_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(Chirp({.upper_amplitude = 0.0}), std::invalid_argument);
  EXPECT_THROW(Step({.rise_s = -0.1}), std::invalid_argument);
  EXPECT_THROW(Multisine({.lowest_frequency_Hz = 1.0, .highest_frequency_Hz = 0.5}),
               std::invalid_argument);
  EXPECT_THROW(Multisine({.highest_frequency_Hz = 1e6}), std::invalid_argument);
  EXPECT_THROW(Move({.speed_rad_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(Samples({0.0}, {0.0}), std::invalid_argument);
  EXPECT_THROW(Samples({0.0, 0.0}, {0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(Samples({0.0, 1.0}, {0.0, nan}), std::invalid_argument);
  const auto hold = std::make_shared<Hold>(0.0);
  EXPECT_THROW(Windowed(hold, 0.0, 1.0, 0.6), std::invalid_argument);
  EXPECT_THROW(Sequence({hold, hold}), std::invalid_argument);  // the first never ends
  EXPECT_THROW(Sequence({std::make_shared<Hold>(0.0, 1.0), std::make_shared<Hold>(0.1)}),
               std::invalid_argument);
  EXPECT_THROW(Sequence({}), std::invalid_argument);
}

TEST(Trajectory, NonFiniteTimeGivesNoCrash) {
  for (const auto& [name, trajectory] : SmoothTrajectories()) {
    for (const double t : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      static_cast<void>(trajectory->At(t));
    }
  }
}

}  // namespace
}  // namespace sinew::reference
