#include <gtest/gtest.h>

#include <algorithm>

#include "components/model/trace/reported.h"
#include "tests/components/model/identify/synthetic.h"
#include "tests/components/model/trace/plain_fit.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

std::vector<ParameterShift> Shifts(const actuator::JointModel& truth,
                                   const actuator::JointModel& model) {
  auto design = MakeDesign({SyntheticRun(truth, {.noise_A = 0.02})}, model);
  const identify::FitResult fit = PlainFit(design, model);
  design.PredictDrive(fit.model);
  return FindShifts(design, model, fit, MakeCandidates(design, fit.model, {}).candidates);
}

TEST(Shift, AParameterInsideItsToleranceIsNoShift) {
  auto model = SyntheticModel();
  model.terms[2].linear[0].value *= 1.1;
  const std::vector<ParameterShift> shifts = Shifts(SyntheticModel(), model);
  EXPECT_TRUE(shifts.empty());
}

TEST(Shift, OneParameterFarOffIsReported) {
  auto model = SyntheticModel();
  model.terms[2].linear[0].value *= 1.6;  // viscous: 0.8 declared, 0.5 true
  const std::vector<ParameterShift> shifts = Shifts(SyntheticModel(), model);
  ASSERT_EQ(shifts.size(), 1u);
  EXPECT_EQ(shifts[0].effect, "viscous");
  EXPECT_NEAR(shifts[0].refit, 0.5, 0.02);
  EXPECT_NEAR(shifts[0].sigma, -0.3 / 0.12, 0.3);
  EXPECT_EQ(std::count(shifts[0].causes.begin(), shifts[0].causes.end(), "viscous"), 0);
}

// Beyond three tolerances the declared value itself is a cause, whatever else points the same way.
TEST(Shift, AValueFarBeyondItsToleranceIsItsOwnCause) {
  auto model = SyntheticModel();
  model.terms[2].linear[0].value *= 1.6;
  model.terms[2].linear[0].tolerance = 0.05;
  const std::vector<ParameterShift> shifts = Shifts(SyntheticModel(), model);
  ASSERT_EQ(shifts.size(), 1u);
  EXPECT_LT(shifts[0].sigma, -3.0);
  EXPECT_EQ(std::count(shifts[0].causes.begin(), shifts[0].causes.end(), "viscous"), 1);
}

TEST(Shift, APayloadIsKnownByGravityAndInertiaTogether) {
  auto truth = SyntheticModel();
  // 0.8 kg at 0.4 m: 3.14 Nm of gravity, 0.128 kg m2.
  truth.terms.push_back(identify::TermOf("payload", {0.8}, truth.constants));
  const std::vector<ParameterShift> shifts = Shifts(truth, SyntheticModel());
  ASSERT_EQ(shifts.size(), 2u);
  for (const ParameterShift& shift : shifts) {
    EXPECT_NE(std::find(shift.causes.begin(), shift.causes.end(), "payload"), shift.causes.end())
        << shift.effect;
  }
}

TEST(Shift, WithoutTolerancesNothingIsSaid) {
  auto truth = SyntheticModel();
  truth.terms.push_back(identify::TermOf("payload", {0.8}, truth.constants));
  auto model = SyntheticModel();
  for (auto& term : model.terms) term.linear[0].tolerance = 0.0;
  EXPECT_TRUE(Shifts(truth, model).empty());
}

}  // namespace
}  // namespace sinew::trace
