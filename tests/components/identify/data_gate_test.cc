#include "components/identify/data_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/components/identify/synthetic.h"

namespace sinew::identify {
namespace {

const Finding* Find(const std::vector<Finding>& findings, const std::string& name) {
  for (const Finding& finding : findings) {
    if (finding.name == name) return &finding;
  }
  return nullptr;
}

std::vector<Finding> Examine(const Run& run) {
  const actuator::JointModel model = SyntheticModel();
  return ExamineData({run}, MakeStates({run}, model, SyntheticProcessing()), model);
}

TEST(DataGate, ACleanRecordingHasOnlyItsRate) {
  const std::vector<Finding> findings =
      Examine(SyntheticRun(SyntheticModel(), {.duration_s = 20.0}));
  ASSERT_EQ(findings.size(), 1u) << findings.back().text;
  EXPECT_NEAR(Find(findings, "rate")->value, 200.0, 1e-6);
}

TEST(DataGate, ALaggingVelocityIsMeasured) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.duration_s = 20.0});
  const Eigen::VectorXd q = run.At(Signal::kPosition);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(q.size());
  for (Eigen::Index i = 3; i + 1 < q.size(); ++i)
    v[i] = (q[i - 1] - q[i - 3]) / 0.01;  // centred 2 samples ago
  run.signals[Signal::kVelocity] = v;
  const std::vector<Finding> findings = Examine(run);
  const Finding* lag = Find(findings, "lag_velocity");
  ASSERT_NE(lag, nullptr);
  EXPECT_NEAR(lag->value, 0.010, 0.0005);
}

TEST(DataGate, SaturationAndConstantsAndStepsAreTold) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.duration_s = 20.0});
  for (double& value : run.signals[Signal::kMotorCurrent]) value = std::clamp(value, -1.5, 1.5);
  for (double& value : run.signals[Signal::kPosition]) value = 1e-3 * std::round(value / 1e-3);
  run.signals[Signal::kTemperature] = Eigen::VectorXd::Constant(run.size(), 25.0);
  const std::vector<Finding> findings = Examine(run);
  EXPECT_NE(Find(findings, "saturation"), nullptr);
  ASSERT_NE(Find(findings, "resolution"), nullptr);
  EXPECT_NEAR(Find(findings, "resolution")->value, 1e-3, 1e-9);
  ASSERT_NE(Find(findings, "constant"), nullptr);
  EXPECT_NE(Find(findings, "constant")->text.find("temperature"), std::string::npos);
}

TEST(DataGate, LostRowsAreCounted) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.duration_s = 20.0});
  identify::Run thin;
  thin.name = run.name;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    if (i % 100 != 50) kept.push_back(i);
  }
  thin.time_s.resize(static_cast<Eigen::Index>(kept.size()));
  for (const auto& [signal, values] : run.signals) {
    thin.signals[signal].resize(static_cast<Eigen::Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      thin.signals[signal][static_cast<Eigen::Index>(k)] = values[kept[k]];
      thin.time_s[static_cast<Eigen::Index>(k)] = run.time_s[kept[k]];
    }
  }
  const std::vector<Finding> findings = Examine(thin);
  ASSERT_NE(Find(findings, "lost_rows"), nullptr);
  EXPECT_EQ(Find(findings, "lost_rows")->value, 40.0);
}

}  // namespace
}  // namespace sinew::identify
