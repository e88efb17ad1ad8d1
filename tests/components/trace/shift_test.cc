#include "components/trace/shift.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

ShiftReport Shifts(const actuator::JointModel& truth, const actuator::JointModel& model) {
  auto design = MakeDesign({SyntheticRun(truth, {.noise_A = 0.02})}, model);
  const auto blocks = identify::MakeBlocks(design.rows(), 1.0, 0.1, 10);
  const auto fit = identify::FitModel(design, model, blocks);
  design.PredictDrive(fit.model);
  return FindShifts(design, model, fit, MakeCandidates(design, fit.model).candidates);
}

TEST(Shift, AParameterInsideItsToleranceIsNoShift) {
  auto model = SyntheticModel();
  model.terms[2].linear[0].value *= 1.1;
  const ShiftReport report = Shifts(SyntheticModel(), model);
  EXPECT_TRUE(report.shifts.empty());
  EXPECT_TRUE(report.causes.empty());
}

TEST(Shift, OneParameterFarOffIsTold) {
  auto model = SyntheticModel();
  model.terms[2].linear[0].value *= 1.6;  // viscous: 0.8 declared, 0.5 true
  const ShiftReport report = Shifts(SyntheticModel(), model);
  ASSERT_EQ(report.shifts.size(), 1u);
  EXPECT_EQ(report.shifts[0].effect, "viscous");
  EXPECT_NEAR(report.shifts[0].refit, 0.5, 0.02);
  EXPECT_NEAR(report.shifts[0].sigma, -0.3 / 0.12, 0.3);
  EXPECT_TRUE(report.causes.empty());
}

TEST(Shift, APayloadIsKnownByGravityAndInertiaTogether) {
  auto truth = SyntheticModel();
  // 0.8 kg at 0.4 m: 3.14 Nm of gravity, 0.128 kg m2.
  truth.terms.push_back(identify::TermOf("payload", {0.8}, truth.constants));
  const ShiftReport report = Shifts(truth, SyntheticModel());
  ASSERT_FALSE(report.causes.empty());
  EXPECT_EQ(report.causes.front().candidate.name(), "payload");
  EXPECT_NEAR(report.causes.front().theta, 0.8, report.causes.front().half_width_95);
  ASSERT_EQ(report.shifts.size(), 2u);
  for (const ParameterShift& shift : report.shifts) {
    EXPECT_NE(std::find(shift.causes.begin(), shift.causes.end(), "payload"), shift.causes.end())
        << shift.effect;
  }
}

TEST(Shift, WithoutTolerancesNothingIsSaid) {
  auto truth = SyntheticModel();
  truth.terms.push_back(identify::TermOf("payload", {0.8}, truth.constants));
  auto model = SyntheticModel();
  for (auto& term : model.terms) term.linear[0].tolerance = 0.0;
  EXPECT_TRUE(Shifts(truth, model).shifts.empty());
}

}  // namespace
}  // namespace sinew::trace
