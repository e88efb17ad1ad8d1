#include "components/model/shooting/shooting_fit.h"

#include <gtest/gtest.h>

#include "sim/plant/joint_body.h"
#include "tests/components/model/shooting/swing.h"

namespace sinew::shooting {
namespace {

Recordings Declaring(const std::vector<types::Run>& runs) {
  return Recordings(runs, Declared(), ProcessingOf(runs, Declared(), 0.25), plant::JointAlone(),
                    {});
}

double ValueIn(const actuator::JointModel& model, const std::string& effect) {
  return model.terms[static_cast<std::size_t>(model.Find(effect))].linear[0].value;
}

// A free swing shows ratios only: all torques in proportion move it alike.
TEST(ShootingFit, AFreeSwingShowsTheRatiosOfItsTerms) {
  const Recordings recordings = Declaring({Swing(Pendulum(), {.duration_s = 8.0})});
  const Fit fit = FitBySimulation(recordings, Declared(), Declared());
  const double inertia = ValueIn(fit.model, "inertia");
  EXPECT_NEAR(ValueIn(fit.model, "gravity") / inertia, kGravity_Nm / kInertia_kg_m2, 0.02);
  EXPECT_NEAR(ValueIn(fit.model, "coulomb") / inertia, kCoulomb_Nm / kInertia_kg_m2,
              0.04 * kCoulomb_Nm / kInertia_kg_m2);
  EXPECT_NEAR(ValueIn(fit.model, "viscous") / inertia, kViscous_Nm_s_rad / kInertia_kg_m2,
              0.04 * kViscous_Nm_s_rad / kInertia_kg_m2);
  EXPECT_LT(fit.rms, 5e-4);  // noise and count of the encoder: 3e-4 rad before the low-pass
  EXPECT_GT(FitStart(recordings, Declared()).rms, 20.0 * fit.rms);
}

// With a drive that is known the scale shows as well, sticking and slipping included.
TEST(ShootingFit, ADriveShowsTheScale) {
  const Recordings recordings = Declaring({Swing(
      Pendulum(), {.duration_s = 8.0, .release_rad = 0.3, .torque_Nm = 1.0, .slow_Hz = 0.4})});
  const actuator::JointModel fitted = FitBySimulation(recordings, Declared(), Declared()).model;
  EXPECT_NEAR(ValueIn(fitted, "inertia"), kInertia_kg_m2, 0.01 * kInertia_kg_m2);
  EXPECT_NEAR(ValueIn(fitted, "gravity"), kGravity_Nm, 0.01 * kGravity_Nm);
  EXPECT_NEAR(ValueIn(fitted, "coulomb"), kCoulomb_Nm, 0.05 * kCoulomb_Nm);
}

TEST(ShootingFit, AnUnknownZeroIsFoundByGravity) {
  types::Run run = Swing(Pendulum(), {.duration_s = 6.0});
  constexpr double kOff_rad = 0.01;
  run.signals[types::Signal::kPosition].array() -= kOff_rad;
  run.zero_unknown.insert(types::Signal::kPosition);
  const Recordings recordings = Declaring({run});
  EXPECT_NEAR(FitBySimulation(recordings, Declared(), Declared()).start.zero_rad[0], kOff_rad,
              5e-4);
  EXPECT_NEAR(FitStart(recordings, Pendulum()).start.zero_rad[0], kOff_rad, 1e-3);
}

TEST(ShootingFit, AFixedParameterStays) {
  const Recordings recordings = Declaring({Swing(Pendulum(), {.duration_s = 3.0})});
  actuator::JointModel declared = Declared();
  declared.terms[2].linear[0].fixed = true;
  EXPECT_EQ(FreeParameters(recordings, declared, declared).size(), 3u);
  EXPECT_EQ(ValueIn(FitBySimulation(recordings, declared, declared).model, "gravity"),
            ValueIn(declared, "gravity"));
}

}  // namespace
}  // namespace sinew::shooting
