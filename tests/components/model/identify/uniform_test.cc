#include "components/model/identify/uniform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::identify {
namespace {

types::Run MakeRun(const Eigen::VectorXd& time, double (*position)(double)) {
  types::Run run;
  run.name = "run";
  run.time_s = time;
  Eigen::VectorXd q(time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) q[i] = position(time[i]);
  run.signals[types::Signal::kPosition] = q;
  return run;
}

double Sine(double t) { return std::sin(2.0 * t); }

TEST(Uniform, SplineAgreesWithSciPy) {
  // scipy 1.10: CubicSpline(t, y, bc_type='natural')([0.4, 1.5, 2.1, 4.9])
  Eigen::VectorXd t(6);
  t << 0.0, 0.9, 2.1, 3.0, 4.2, 5.0;
  Eigen::VectorXd y(6);
  y << 0.0, 1.0, 0.5, -1.0, 2.0, 1.5;
  Eigen::VectorXd at(4);
  at << 0.4, 1.5, 2.1, 4.9;
  const Eigen::VectorXd s = SplineAt(t, y, at);
  EXPECT_NEAR(s[0], 0.504033979903789, 1e-12);
  EXPECT_NEAR(s[1], 1.15903351698806, 1e-12);
  EXPECT_NEAR(s[2], 0.5, 1e-12);
  EXPECT_NEAR(s[3], 1.6584780690427, 1e-12);
}

TEST(Uniform, AnEvenRecordingIsCopiedBitByBit) {
  Eigen::VectorXd t(3000);
  for (int i = 0; i < 3000; ++i) t[i] = 0.001 * i;
  const types::Run run = MakeRun(t, Sine);
  const UniformRun out = MakeUniform(run);
  ASSERT_EQ(out.segments.size(), 1u);
  EXPECT_TRUE(out.sampling.even);
  EXPECT_NEAR(out.sampling.rate_Hz, 1000.0, 1e-6);
  EXPECT_TRUE(out.segments[0].signals.at(types::Signal::kPosition) ==
              run.At(types::Signal::kPosition));
}

TEST(Uniform, ARateThatChangesOnTheWayLosesNoRowAndNoTime) {
  // 190 Hz for 2 s, then 250 Hz for 4 s, stamps scattered: no even count of rows explains them.
  std::mt19937_64 random(5);
  std::normal_distribution<double> jitter(0.0, 2e-4);
  std::vector<double> stamps;
  for (double t = 0.0; t < 6.0; t += t < 2.0 ? 0.0053 : 0.004) stamps.push_back(t + jitter(random));
  const Eigen::VectorXd time =
      Eigen::Map<const Eigen::VectorXd>(stamps.data(), static_cast<Eigen::Index>(stamps.size()));
  const UniformRun out = MakeUniform(MakeRun(time, Sine));
  ASSERT_EQ(out.segments.size(), 1u);
  const UniformSegment& segment = out.segments[0];
  EXPECT_TRUE(out.sampling.stamps_used);
  EXPECT_EQ(out.sampling.lost_rows, 0);
  EXPECT_NEAR(segment.Time(segment.size() - 1), stamps.back(), 0.005);
  const Eigen::VectorXd& q = segment.signals.at(types::Signal::kPosition);
  for (Eigen::Index i = 0; i < segment.size(); ++i) {
    EXPECT_NEAR(q[i], Sine(segment.Time(i)), 2e-3) << i;  // the half step at either end
  }
}

TEST(Uniform, JitterAndLostRowsAreBroughtOntoTheGrid) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> jitter(0.0, 4e-4);
  std::vector<double> stamps;
  int lost = 0;
  for (int i = 0; i < 2000; ++i) {
    if (i % 97 == 50) {
      ++lost;
      continue;
    }
    stamps.push_back(0.0125 * i + jitter(random));
  }
  const Eigen::VectorXd t =
      Eigen::Map<Eigen::VectorXd>(stamps.data(), static_cast<Eigen::Index>(stamps.size()));
  const UniformRun out = MakeUniform(MakeRun(t, Sine));
  ASSERT_EQ(out.segments.size(), 1u);
  const UniformSegment& piece = out.segments[0];
  EXPECT_EQ(out.sampling.lost_rows, lost);
  EXPECT_TRUE(out.sampling.stamps_used);
  EXPECT_NEAR(piece.period_s, 0.0125, 1e-6);
  int invalid = 0;
  for (Eigen::Index i = 2; i + 2 < piece.size(); ++i) {
    // A spline through steps of 12.5 ms follows 2 rad/s to h^4 w^4 / 384.
    EXPECT_NEAR(piece.signals.at(types::Signal::kPosition)[i], Sine(piece.Time(i)), 2e-5);
    invalid += piece.valid[static_cast<std::size_t>(i)] ? 0 : 1;
  }
  EXPECT_EQ(invalid, 3 * lost);  // the lost row and its two rims
}

TEST(Uniform, StampsThatLieAreReplacedByRowNumbers) {
  // True instants are even, the stamps scatter.
  std::mt19937_64 random(12);
  std::normal_distribution<double> jitter(0.0, 1e-3);
  types::Run run;
  run.name = "run";
  run.time_s.resize(2000);
  Eigen::VectorXd q(2000);
  for (int i = 0; i < 2000; ++i) {
    run.time_s[i] = 0.0125 * i + jitter(random);
    q[i] = Sine(0.0125 * i);
  }
  run.signals[types::Signal::kPosition] = q;
  const UniformRun out = MakeUniform(run);
  EXPECT_FALSE(out.sampling.stamps_used);
  const UniformSegment& piece = out.segments[0];
  for (Eigen::Index i = 2; i + 2 < piece.size(); ++i) {
    EXPECT_NEAR(piece.signals.at(types::Signal::kPosition)[i], q[i], 1e-9);
  }
}

TEST(Uniform, LongGapsCutTheRecordingAndShortPiecesFallAway) {
  std::vector<double> stamps;
  for (int i = 0; i < 500; ++i) stamps.push_back(0.01 * i);
  for (int i = 0; i < 30; ++i) stamps.push_back(10.0 + 0.01 * i);
  for (int i = 0; i < 400; ++i) stamps.push_back(20.0 + 0.01 * i);
  const Eigen::VectorXd t =
      Eigen::Map<Eigen::VectorXd>(stamps.data(), static_cast<Eigen::Index>(stamps.size()));
  const UniformRun out = MakeUniform(MakeRun(t, Sine));
  ASSERT_EQ(out.segments.size(), 2u);
  EXPECT_NEAR(out.segments[1].start_s, 20.0, 1e-9);
}

TEST(Uniform, SwitchesKeepTheirLastValue) {
  Eigen::VectorXd t(1000);
  for (int i = 0; i < 1000; ++i) t[i] = 0.01 * i + (i % 3 == 0 ? 1e-3 : 0.0);
  types::Run run = MakeRun(t, Sine);
  Eigen::VectorXd valve(1000);
  for (int i = 0; i < 1000; ++i) valve[i] = i < 500 ? 0.0 : 1.0;
  run.signals[types::Signal::kValveOpen] = valve;
  const UniformRun out = MakeUniform(run);
  for (const double value : out.segments[0].signals.at(types::Signal::kValveOpen)) {
    EXPECT_TRUE(value == 0.0 || value == 1.0) << value;
  }
}

TEST(Uniform, TooShortRecordingsAreRefusedByName) {
  try {
    MakeUniform(MakeRun(Eigen::VectorXd::LinSpaced(10, 0.0, 1.0), Sine));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("run"), std::string::npos);
  }
  EXPECT_THROW(MakeUniform(MakeRun(Eigen::VectorXd::LinSpaced(50, 0.0, 1.0), Sine)),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::identify
