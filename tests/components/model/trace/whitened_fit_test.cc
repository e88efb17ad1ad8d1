// The fit of a model's declared terms: parameters and their intervals.
#include "components/model/trace/whitened_fit.h"

#include <gtest/gtest.h>

#include "tests/components/model/identify/synthetic.h"
#include "tests/components/model/trace/plain_fit.h"

namespace sinew::trace {
namespace {

using identify::Design;
using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

actuator::JointModel Detuned() {
  actuator::JointModel model = SyntheticModel();
  for (actuator::Term& term : model.terms) {
    if (!term.linear[0].fixed) term.linear[0].value *= 1.1;
  }
  return model;
}

TEST(WhitenedFit, NoiseFreeRecordingsGiveTheParametersBack) {
  const actuator::JointModel truth = SyntheticModel();
  const Design design = MakeDesign({SyntheticRun(truth, {.noise_A = 0.0})}, truth);
  const identify::FitResult fit = PlainFit(design, Detuned());
  EXPECT_TRUE(fit.balance.fits_scale);
  for (std::size_t t = 0; t < truth.terms.size(); ++t) {
    // Left: the reversals' Coulomb steps against the state filter.
    EXPECT_NEAR(fit.model.terms[t].linear[0].value, truth.terms[t].linear[0].value,
                3e-3 * truth.terms[t].linear[0].value)
        << truth.terms[t].effect->info().name;
  }
  EXPECT_LT(identify::ErrorOf(design, fit.model).percent, 0.2);
}

TEST(WhitenedFit, IntervalsCoverTheTruth) {
  const actuator::JointModel truth = SyntheticModel();
  int covered = 0;
  int asked = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Design design = MakeDesign(
        {SyntheticRun(truth,
                      {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.1, .noise_memory = 0.9})},
        truth);
    const identify::FitResult fit = PlainFit(design, Detuned());
    for (std::size_t t = 0; t < truth.terms.size(); ++t) {
      if (truth.terms[t].linear[0].fixed) continue;
      ++asked;
      const actuator::ParameterValue& value = fit.model.terms[t].linear[0];
      ASSERT_TRUE(value.half_width_95.has_value());
      covered +=
          std::abs(value.value - truth.terms[t].linear[0].value) < *value.half_width_95 ? 1 : 0;
    }
  }
  // 120 intervals of 95 %, five of a recording correlated: 85 to 100 % passes.
  EXPECT_GE(covered, static_cast<int>(0.85 * asked)) << covered << " of " << asked;
}

TEST(WhitenedFit, WithoutAKnownTorqueTheScaleStaysNominal) {
  actuator::JointModel truth = SyntheticModel();
  types::Run run = SyntheticRun(truth, {});
  truth.terms.pop_back();  // no load cell in the model
  run = SyntheticRun(truth, {});
  run.signals.erase(types::Signal::kLoadForce);
  const Design design = MakeDesign({run}, truth);
  actuator::JointModel model = truth;
  model.terms[0].linear[0].value = 0.9;
  const identify::FitResult fit = PlainFit(design, model);
  EXPECT_FALSE(fit.balance.fits_scale);
  EXPECT_DOUBLE_EQ(fit.model.terms[0].linear[0].value, 0.9);
  // Everything else is seen in proportion.
  EXPECT_NEAR(fit.model.terms[1].linear[0].value, 0.3 * 0.9 / 0.8, 0.005);
}

TEST(WhitenedFit, TooFewRowsAreRefused) {
  const actuator::JointModel truth = SyntheticModel();
  const Design design = MakeDesign(
      {SyntheticRun(truth, {.rate_Hz = 50.0, .duration_s = 2.1})}, truth,
      {.state_cutoff_Hz = 10, .parallel_cutoff_Hz = 2, .rest_velocity = 0.3, .border_s = 0.9});
  EXPECT_THROW(PlainFit(design, truth), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::trace
