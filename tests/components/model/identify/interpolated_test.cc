#include "components/model/identify/interpolated.h"

#include <gtest/gtest.h>

#include "tests/components/model/identify/synthetic.h"

namespace sinew::identify {
namespace {

types::Run Measured() {
  return SyntheticRun(SyntheticModel(),
                      {.rate_Hz = 100.0, .duration_s = 20.0, .seed = 5, .noise_A = 0.05});
}

// m - 1 rows on the line between every two.
types::Run Upsampled(const types::Run& run, int m) {
  types::Run out = run;
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
  const types::Run run = Measured();
  for (const int m : {2, 4, 10}) {
    const types::Run more = Upsampled(run, m);
    const types::Run left = WithoutInterpolatedRows(more);
    EXPECT_EQ(left.interpolated_rows, more.size() - run.size());
    EXPECT_EQ(left.time_s, run.time_s) << m;
    for (const auto& [signal, x] : run.signals)
      EXPECT_EQ(left.At(signal), x) << types::SignalName(signal);
  }
}

TEST(Interpolated, WhatWasMeasuredStays) {
  const types::Run run = Measured();
  const types::Run same = WithoutInterpolatedRows(run);
  EXPECT_EQ(same.interpolated_rows, 0);
  EXPECT_EQ(same.size(), run.size());

  // One channel alone may come at half of the rate.
  types::Run held = run;
  Eigen::VectorXd& current = held.signals[types::Signal::kMotorCurrent];
  for (Eigen::Index i = 1; i + 1 < current.size(); i += 2) {
    current[i] = 0.5 * (current[i - 1] + current[i + 1]);
  }
  EXPECT_EQ(WithoutInterpolatedRows(held).interpolated_rows, 0);
}

TEST(Interpolated, ARestAndCoarseCountsAreNoLine) {
  types::Run run = Measured();
  for (auto& [signal, x] : run.signals) {
    const double count = 0.05 * (x.maxCoeff() - x.minCoeff());
    x = count * (x.array() / count).round();
  }
  EXPECT_EQ(WithoutInterpolatedRows(run).interpolated_rows, 0);
  for (auto& [signal, x] : run.signals) x.setConstant(1.0);
  EXPECT_EQ(WithoutInterpolatedRows(run).interpolated_rows, 0);
  run.held = true;
  EXPECT_EQ(WithoutInterpolatedRows(run).interpolated_rows, 0);
}

}  // namespace
}  // namespace sinew::identify
