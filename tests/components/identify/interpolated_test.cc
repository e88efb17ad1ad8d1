#include "components/identify/interpolated.h"

#include <gtest/gtest.h>

#include "tests/components/identify/synthetic.h"

namespace sinew::identify {
namespace {

Run Measured() {
  return SyntheticRun(SyntheticModel(),
                      {.rate_Hz = 100.0, .duration_s = 20.0, .seed = 5, .noise_A = 0.05});
}

// m - 1 rows on the line between every two.
Run Upsampled(const Run& run, int m) {
  Run out = run;
  const Eigen::Index rows = (run.size() - 1) * m + 1;
  const auto fill = [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd y(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Eigen::Index k = std::min<Eigen::Index>(i / m, x.size() - 2);
      const double along = static_cast<double>(i - k * m) / m;
      y[i] = x[k] + along * (x[k + 1] - x[k]);
    }
    return y;
  };
  out.time_s = fill(run.time_s);
  for (auto& [signal, x] : out.signals) x = fill(x);
  return out;
}

TEST(Interpolated, TheMeasuredRowsAreLeft) {
  const identify::Run run = Measured();
  for (const int m : {2, 4, 10}) {
    const identify::Run more = Upsampled(run, m);
    EXPECT_EQ(RowsPerMeasured(more), m);
    const identify::Run left = WithoutInterpolatedRows(more);
    EXPECT_EQ(left.interpolated_rows, more.size() - run.size());
    EXPECT_EQ(left.time_s, run.time_s) << m;
    for (const auto& [signal, x] : run.signals) EXPECT_EQ(left.At(signal), x) << SignalName(signal);
  }
}

TEST(Interpolated, WhatWasMeasuredStays) {
  const identify::Run run = Measured();
  EXPECT_EQ(RowsPerMeasured(run), 1);
  const identify::Run same = WithoutInterpolatedRows(run);
  EXPECT_EQ(same.interpolated_rows, 0);
  EXPECT_EQ(same.size(), run.size());

  // One channel alone may come at half of the rate.
  identify::Run held = run;
  Eigen::VectorXd& current = held.signals[Signal::kMotorCurrent];
  for (Eigen::Index i = 1; i + 1 < current.size(); i += 2) {
    current[i] = 0.5 * (current[i - 1] + current[i + 1]);
  }
  EXPECT_EQ(RowsPerMeasured(held), 1);
}

TEST(Interpolated, ARestAndCoarseCountsAreNoLine) {
  identify::Run run = Measured();
  for (auto& [signal, x] : run.signals) {
    const double count = 0.05 * (x.maxCoeff() - x.minCoeff());
    x = count * (x.array() / count).round();
  }
  EXPECT_EQ(RowsPerMeasured(run), 1);
  for (auto& [signal, x] : run.signals) x.setConstant(1.0);
  EXPECT_EQ(RowsPerMeasured(run), 1);
  run.held = true;
  EXPECT_EQ(RowsPerMeasured(run), 1);
}

}  // namespace
}  // namespace sinew::identify
