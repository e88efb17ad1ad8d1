// The formulas that the catalogue states, written out again: signs, sizes, lags.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "components/model/effects/effect.h"

namespace sinew::effects {
namespace {

JointConstants FormConstants() {
  return {.gear_ratio = 100.0,
          .link_length_m = 0.3,
          .gravity_m_s2 = 9.81,
          .torque_constant_Nm_A = 0.0159155,
          .force_constant_N_V = 0.0,
          .pneumatic_torque_Nm_bar = 0.4,
          .pneumatic_stiffness_Nm_rad_bar = 3.0,
          .pneumatic_rest_rad = 0.2};
}

// One sample at which every signal differs from every other.
JointSample StatedSample() {
  JointSample x;
  x.time_s = 1.2;
  x.position_rad = 0.5;
  x.velocity_rad_s = -0.4;
  x.acceleration_rad_s2 = 2.0;
  x.jerk_rad_s3 = 3.0;
  x.snap_rad_s4 = -4.0;
  x.motor_position_rad = 7.0;
  x.motor_velocity_rad_s = -40.0;
  x.motor_acceleration_rad_s2 = 200.0;
  x.drive_input = 1.5;
  x.drive_rate = 0.8;
  x.pressure_bar = 4.0;
  x.pressure_rate_bar_s = 0.6;
  x.load_force_N = 10.0;
  x.payload_kg = 0.7;
  x.temperature_degC = 40.0;
  x.rigid_torque_Nm = 0.9;
  return x;
}

// The formulas that the catalogue states, written out again with their signs, for effects of the
// torque balance without memory: torque per linear parameter at StatedSample(). Positive torque
// drives the output up.
struct StatedForm {
  const char* effect;
  std::vector<double> psi;
  std::vector<double> torque_per_parameter;
};

TEST(CatalogueForms, HaveTheSignAndSizeOfTheirFormulas) {
  // q, v, a, I, P, F, m as in StatedSample(); N Kt = 100 x 0.0159155; l = 0.3 m; K = 0.4 Nm/bar,
  // k1 = 3 Nm/(rad bar), q0 = 0.2 rad.
  constexpr double q = 0.5, v = -0.4, a = 2.0, I = 1.5, P = 4.0, F = 10.0, m = 0.7;
  constexpr double kDrive = 1.59155, l = 0.3, g = 9.81, warmer_K = 15.0, bump = 0.5;
  const double s = std::sin(q), c = std::cos(q), per_bar = 0.4 - 3.0 * (q - 0.2);
  const double load = l * l * a + g * l * c;
  const std::vector<StatedForm> forms = {
      {"cogging", {3.0}, {std::sin(21.0), std::cos(21.0)}},
      {"coulomb", {}, {1.0}},
      {"current_offset", {}, {kDrive}},
      {"declared_payload", {}, {-m * load}},
      {"direction_dependent_coulomb", {}, {-1.0}},
      {"direction_dependent_quadratic_viscous", {}, {-v * v}},
      {"direction_dependent_viscous", {}, {v}},
      {"drive_current", {}, {kDrive * I}},
      {"drive_efficiency_direction", {}, {kDrive * I}},
      {"drive_torque", {}, {I}},
      {"elastic_joint", {}, {-3.0}},
      {"external_bump", {1.1, 0.4}, {bump}},
      {"gear_compliance", {}, {4.0}},
      {"gravity", {}, {-c}},
      {"gravity_phase", {}, {s, m * g * l * s}},
      {"inertia", {}, {-a}},
      {"link_inertia", {}, {-a}},
      {"load_cell_gain", {}, {-F * l}},
      {"load_cell_misalignment", {}, {-F * l * s, -F * l * (1.0 - c)}},
      {"load_dependent_friction", {}, {kDrive * I}},
      {"load_force", {}, {-F * l}},
      {"motor_viscous", {}, {0.4}},
      {"offset", {}, {1.0}},
      {"payload", {}, {-load}},
      {"payload_step", {1.0}, {-load}},
      {"payload_step", {1.3}, {0.0}},
      {"pneumatic_stiffness", {0.2}, {-P * (q - 0.2)}},
      {"pneumatic_torque", {}, {P}},
      {"pressure_dependent_friction", {}, {P}},
      {"pressure_gain", {}, {-P * per_bar}},
      {"pressure_lag", {}, {0.6 * per_bar}},
      {"pressure_offset", {}, {-per_bar}},
      {"quadratic_viscous", {}, {0.16}},
      {"rigid_body", {}, {-0.9}},
      {"rotor_inertia", {}, {-2.0}},
      {"spring", {}, {-q, 1.0}},
      {"stiffness_collapse", {2.0}, {-P * std::exp(-P / 2.0) * per_bar}},
      {"stribeck", {0.5}, {std::exp(-0.64)}},
      {"temperature_friction", {}, {warmer_K, -warmer_K * v}},
      {"torque_constant_gain", {}, {kDrive * I}},
      {"torque_constant_saturation", {}, {-kDrive * I * I * I}},
      {"viscous", {}, {-v}},
  };
  std::set<std::string> stated = {"drive_voltage", "gear_eccentricity"};  // tested by themselves
  for (const StatedForm& form : forms) {
    stated.insert(form.effect);
    const auto effect = MakeEffect(form.effect, FormConstants());
    ASSERT_EQ(effect->info().nonlinear.size(), form.psi.size()) << form.effect;
    ASSERT_EQ(effect->info().linear.size(), form.torque_per_parameter.size()) << form.effect;
    std::vector<double> phi(form.torque_per_parameter.size());
    effect->Regressors(StatedSample(), form.psi, {}, phi);
    for (std::size_t i = 0; i < phi.size(); ++i) {
      EXPECT_NEAR(phi[i], form.torque_per_parameter[i], 1e-12) << form.effect << " " << i;
    }
  }
  for (const EffectForm& form : EffectForms()) {
    const auto effect = MakeEffect(form.name, FormConstants(), form.balance);
    if (form.balance != Balance::kMotion || effect->memory_size() > 0) continue;
    EXPECT_EQ(stated.count(form.name), 1u) << form.name << " has no stated form in this table";
  }
}

// + gain u, with u in volts and the force constant of the drive: what one volt gives.
TEST(DriveVoltage, IsTheForceConstantTimesTheVoltage) {
  JointConstants constants = FormConstants();
  constants.force_constant_N_V = 35.0;
  double phi = 0.0;
  MakeEffect("drive_voltage", constants)->Regressors(StatedSample(), {}, {}, {&phi, 1});
  EXPECT_NEAR(phi, 1.5, 1e-12);
}

// + (a + c T) sin(n q) + (b + d T) cos(n q), T = N Kt I.
TEST(GearEccentricity, IsARippleOverTheOutputThatGrowsWithTheLoad) {
  const auto effect = MakeEffect("gear_eccentricity", FormConstants());
  const std::vector<double> psi = {2.0};
  std::array<double, 4> phi{};
  effect->Regressors(StatedSample(), psi, {}, phi);
  const double load_Nm = 1.59155 * 1.5;
  const std::array<double, 4> stated = {std::sin(1.0), std::cos(1.0), load_Nm * std::sin(1.0),
                                        load_Nm * std::cos(1.0)};
  for (std::size_t i = 0; i < phi.size(); ++i) EXPECT_NEAR(phi[i], stated[i], 1e-12) << i;
}

// The area between a step of the drive's rate and its lagged mean is the mean lag: stage k of n
// lags by k T / n, so the mean over the stages is T (n + 1) / (2 n) with n = 4. The sums are of
// samples, each up to half a step late: 1 % at 1/400 of the lag.
TEST(TransportDelay, WithASpanLagsByTheMeanOfItsStages) {
  const auto effect = MakeEffect("transport_delay", FormConstants());
  constexpr double kSpan_s = 0.04, kStep_s = 1e-4 / 4.0, kGain = 1.59155;
  const std::vector<double> psi = {kSpan_s};
  std::vector<double> memory(static_cast<std::size_t>(effect->memory_size()));
  JointSample x;
  effect->ResetMemory(x, psi, memory);
  x.drive_rate = 1.0;
  double area_s = 0.0;
  for (double t = 0.0; t < 20.0 * kSpan_s; t += kStep_s) {
    double phi = 0.0;
    effect->Advance(x, kStep_s, psi, memory);
    effect->Regressors(x, psi, memory, {&phi, 1});
    area_s += (1.0 + phi / kGain) * kStep_s;
  }
  EXPECT_NEAR(area_s, kSpan_s * 5.0 / 8.0, 0.01 * kSpan_s);
}

}  // namespace
}  // namespace sinew::effects
