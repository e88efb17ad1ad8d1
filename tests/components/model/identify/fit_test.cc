#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "components/model/identify/as_published.h"
#include "components/model/identify/balance.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::identify {
namespace {

// A held-out recording may lack the load that set the scale in training.
TEST(Fit, ABalanceHasTheFormOfOtherRecordingsWhereThatIsGiven) {
  const actuator::JointModel model = SyntheticModel();
  const Design loaded = MakeDesign({SyntheticRun(model, {})}, model);
  const Design unloaded = MakeDesign({SyntheticRun(model, {.seed = 2, .load_N = 0.0})}, model);
  const Balance train = MakeBalance(loaded, model), own = MakeBalance(unloaded, model);
  ASSERT_TRUE(train.fits_scale);
  EXPECT_FALSE(own.fits_scale);
  const Balance alike = MakeBalance(unloaded, model, train.fits_scale);
  EXPECT_TRUE(alike.fits_scale);
  EXPECT_EQ(alike.columns.cols(), train.columns.cols());
  EXPECT_EQ(alike.nominal, train.nominal);
}

TEST(Fit, ResidualOfTheTrueModelIsTheNoise) {
  const actuator::JointModel truth = SyntheticModel();
  const Design design = MakeDesign({SyntheticRun(truth, {.noise_A = 0.05})}, truth);
  // 0.05 A * 50 * 0.02 Nm/A * 0.8 through a filter that keeps 8 of 100 Hz (zero phase: 0.95 of it).
  const double expected = 0.05 * 50 * 0.02 * 0.8 * std::sqrt(0.08 * 0.95);
  EXPECT_NEAR(ErrorOf(design, truth).rms, expected, 0.15 * expected);
}

TEST(Fit, PredictedDriveIsTheModelsOwn) {
  const actuator::JointModel truth = SyntheticModel();
  Design design = MakeDesign({SyntheticRun(truth, {.noise_A = 0.5})}, truth);
  design.PredictDrive(truth);
  const effects::JointSample& x = design.states().segments[0].samples[5000];
  EXPECT_NEAR(x.drive_input, truth.RequiredDriveInput(x, {}), 1e-12);
}

// A ripple that is faster than the low-pass of the angles is answered by an acceleration that they
// do not show, also where the rows alias it to a slow one.
TEST(Design, ARippleCountsAsFarAsTheAnglesShowItsAcceleration) {
  const actuator::JointModel truth = SyntheticModel();
  const types::Run run = SyntheticRun(truth, {.motor_position = true});
  const ProcessingOptions options = FromMotion({run}, truth, 0.25);
  ASSERT_TRUE(options.raw);
  const Design design = MakeDesign({run}, truth, options);
  const auto cogging = effects::MakeEffect("cogging", truth.constants);
  constexpr double kOrder = 12.0;
  const std::vector<double> psi = {kOrder};
  const Eigen::MatrixXd columns = design.Columns(*cogging, psi);
  const Eigen::VectorXd speed =
      design.Variable([](const effects::JointSample& x) { return x.motor_velocity_rad_s; });
  double least = 1.0, most = 0.0;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double frequency_Hz = kOrder * std::abs(speed[i]) / (2.0 * M_PI);
    const double passed =
        1.0 / (1.0 + std::pow(frequency_Hz / options.state_cutoff_Hz, 2.0 * options.state_order));
    EXPECT_NEAR(columns.row(i).norm(), passed, 1e-6);
    least = std::min(least, passed);
    most = std::max(most, passed);
  }
  EXPECT_LT(least, 0.05);
  EXPECT_GT(most, 0.95);
}

TEST(AsPublished, RecoversALinearModelFromItsOwnData) {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.pop_back();
  truth.terms[0].linear[0].fixed = true;
  const types::Run train = SyntheticRun(truth, {.seed = 1, .noise_A = 0.05});
  const types::Run cross = SyntheticRun(truth, {.seed = 2, .noise_A = 0.05});
  actuator::JointModel model = truth;
  model.terms[2].linear[0].value = 0.0;
  const AsPublishedResult result =
      RunAsPublished(train, cross, model,
                     {.filter_order = 4,
                      .cutoff_Hz = 20.0,
                      .border_samples = 50,
                      .decimate = 5,
                      .added_effects = {"direction_dependent_viscous"}});
  EXPECT_NEAR(result.before.terms[2].linear[0].value, 0.5, 0.01);
  EXPECT_LE(result.after_percent, result.before_percent);
  EXPECT_LT(result.cross_before_percent, 3.0);
  EXPECT_EQ(result.after.terms.size(), truth.terms.size() + 1);
  EXPECT_NEAR(result.after.terms.back().linear[0].value, 0.0, 0.02);
}

TEST(AsPublished, GapsAndShortRecordingsAreRefused) {
  actuator::JointModel truth = SyntheticModel();
  const types::Run run = SyntheticRun(truth, {.duration_s = 3.0});
  EXPECT_THROW(RunAsPublished(run, run, truth, {.border_samples = 400}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::identify
