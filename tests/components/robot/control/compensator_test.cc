// Oracles: (7.1) and the rig's declared balance written out by hand; a term's own torque.
#include "components/robot/control/compensator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/components/robot/control/terms.h"
#include "tests/support/rig_constants.h"

namespace sinew::control {
namespace {

constexpr double kTolerance = 1e-12;  // rounding of a dozen operations on numbers near 1

constexpr double kN = 100.0, kEta = 0.77, kKt = 0.0159155;
constexpr double kJm = 0.115, kJl = 0.0132, kB = 0.31, kTc = 0.22, kTg = 0.58, kK = 0.3587,
                 kK1 = 4.0;
constexpr double kQ0 = 0.16, kL = 0.3, kG = 9.81;

actuator::JointModel Rig() {
  actuator::JointModel model;
  model.name = "joint";
  model.constants = {
      .gear_ratio = kN, .link_length_m = kL, .gravity_m_s2 = kG, .torque_constant_Nm_A = kKt};
  AddTerm(&model, "drive_current", {kEta});
  AddTerm(&model, "rotor_inertia", {kJm});
  AddTerm(&model, "link_inertia", {kJl});
  AddTerm(&model, "declared_payload", {1.0});
  AddTerm(&model, "motor_viscous", {kB});
  AddTerm(&model, "coulomb", {kTc});
  AddTerm(&model, "gravity", {kTg});
  AddTerm(&model, "pneumatic_torque", {kK});
  AddTerm(&model, "pneumatic_stiffness", {kK1}, {kQ0});
  AddTerm(&model, "load_force", {1.0});
  return model;
}

MeasuredJointState Measured() {
  MeasuredJointState m;
  m.valid = m.actuator_valid = true;
  m.position_rad = 0.1;
  m.motor_position_rad = 12.0;
  m.pressure_bar = 4.0;
  m.load_force_N = 1.5;
  m.payload_kg = 0.5;
  return m;
}

const Point kMoving{0.3, 0.8, -2.0};

TEST(Compensator, LinearIsEquation71AtTheMotorShaft) {
  const MeasuredJointState m = Measured();
  Compensator compensator(Rig(), {.kind = CompensatorKind::kLinear});
  const double j_total = (kJm + kJl + m.payload_kg * kL * kL) / (kN * kN);
  const double b_total = kB / (kN * kN);
  const double k_total = kK1 * m.pressure_bar / (kN * kN);
  const double dw = kN * kMoving.acceleration_rad_s2, w = kN * kMoving.velocity_rad_s;
  const double theta = kN * (kMoving.position_rad - kQ0);
  const double tau_c = j_total * dw + b_total * w + k_total * theta - kK * m.pressure_bar / kN +
                       m.load_force_N * kL / kN;
  EXPECT_NEAR(compensator.Step(kMoving, m, kCycle_s), tau_c / kEta, kTolerance);
}

double Balance(const Point& p, const MeasuredJointState& m, double sign_v) {
  return (kJm + kJl + m.payload_kg * kL * kL) * p.acceleration_rad_s2 + kB * p.velocity_rad_s +
         kTc * sign_v + (kTg + m.payload_kg * kG * kL) * std::cos(p.position_rad) -
         kK * m.pressure_bar + kK1 * m.pressure_bar * (p.position_rad - kQ0) + kL * m.load_force_N;
}

TEST(Compensator, ModelIsTheWholeDeclaredBalance) {
  const MeasuredJointState m = Measured();
  Compensator compensator(Rig(), {.kind = CompensatorKind::kModel});
  EXPECT_NEAR(compensator.Step(kMoving, m, kCycle_s), Balance(kMoving, m, 1.0) / (kN * kEta),
              kTolerance);
}

TEST(Compensator, SmoothsTheSignOfVelocityByAStraightLine) {
  const MeasuredJointState m = Measured();
  const double v_s = 0.05;
  Compensator compensator(Rig(), {.kind = CompensatorKind::kModel, .smoothing_rad_s = v_s});
  for (double v = -0.1; v <= 0.1; v += 0.01) {
    const Point p{0.3, v, 0.0};
    const double sign = std::clamp(v / v_s, -1.0, 1.0);
    EXPECT_NEAR(compensator.Step(p, m, kCycle_s), Balance(p, m, sign) / (kN * kEta), kTolerance)
        << v;
  }
}

TEST(Compensator, CompensatesAnEffectThatWasAddedToTheModel) {
  const MeasuredJointState m = Measured();
  for (const char* name :
       {"stribeck", "direction_dependent_viscous", "quadratic_viscous", "cogging", "offset"}) {
    actuator::JointModel more = Rig();
    AddTerm(&more, name, {0.2});
    Compensator declared(Rig(), {.kind = CompensatorKind::kModel});
    Compensator corrected(more, {.kind = CompensatorKind::kModel});
    effects::JointSample x;
    x.position_rad = kMoving.position_rad;
    x.velocity_rad_s = kMoving.velocity_rad_s;
    x.acceleration_rad_s2 = kMoving.acceleration_rad_s2;
    x.motor_position_rad = m.motor_position_rad;  // measured: the play hides it from the reference
    x.motor_velocity_rad_s = kN * kMoving.velocity_rad_s;
    const double torque_Nm = more.TermTorque(static_cast<int>(more.terms.size()) - 1, x, {});
    EXPECT_NE(torque_Nm, 0.0) << name;
    EXPECT_NEAR(corrected.Step(kMoving, m, kCycle_s) - declared.Step(kMoving, m, kCycle_s),
                -torque_Nm / (kN * kEta), kTolerance)
        << name;
  }
}

TEST(Compensator, HysteresisFollowsTheReference) {
  actuator::JointModel more = Rig();
  AddTerm(&more, "seal_hysteresis", {0.1}, {0.01});
  const MeasuredJointState m = Measured();
  Compensator declared(Rig(), {.kind = CompensatorKind::kModel});
  Compensator corrected(more, {.kind = CompensatorKind::kModel});
  double extra = 0.0;
  for (int k = 0; k < 240;
       ++k) {  // up by 0.2 rad: twenty times the length over which the seal turns
    const Point p{0.2 * k / 240.0, 0.2, 0.0};
    extra = corrected.Step(p, m, kCycle_s) - declared.Step(p, m, kCycle_s);
  }
  EXPECT_NEAR(extra, 0.1 * m.pressure_bar / (kN * kEta), 1e-9);
}

TEST(Compensator, APrismaticAxisGetsForceAtTheOutput) {
  actuator::JointModel axis;
  axis.kind = types::JointKind::kPrismatic;
  axis.constants.force_constant_N_V = 35.15;
  AddTerm(&axis, "drive_voltage", {35.15});
  AddTerm(&axis, "inertia", {95.0});
  AddTerm(&axis, "viscous", {200.0});
  AddTerm(&axis, "coulomb", {20.0});
  EXPECT_NEAR(ShaftPerOutput(axis), 1.0, kTolerance);
  Compensator compensator(axis, {.kind = CompensatorKind::kModel, .smoothing_rad_s = 0.001});
  const Point p{0.1, 0.2, 0.5};
  EXPECT_NEAR(compensator.Step(p, {}, 1e-3), 95.0 * 0.5 + 200.0 * 0.2 + 20.0, 1e-9);
}

TEST(Compensator, LeadLooksAlongTheReference) {
  const MeasuredJointState m = Measured();
  Compensator now(Rig(), {.kind = CompensatorKind::kLinear});
  Compensator ahead(Rig(), {.kind = CompensatorKind::kLinear, .lead_s = 0.01});
  const Point later{
      kMoving.position_rad + 0.01 * kMoving.velocity_rad_s + 0.5e-4 * kMoving.acceleration_rad_s2,
      kMoving.velocity_rad_s + 0.01 * kMoving.acceleration_rad_s2, kMoving.acceleration_rad_s2};
  EXPECT_NEAR(ahead.Step(kMoving, m, kCycle_s), now.Step(later, m, kCycle_s), kTolerance);
}

TEST(Compensator, WithoutAKindItAddsNothing) {
  Compensator compensator(Rig(), {});
  EXPECT_EQ(compensator.Step(kMoving, Measured(), kCycle_s), 0.0);
}

TEST(Compensator, BadConfigurationIsRefused) {
  EXPECT_THROW(Compensator({}, {}), std::invalid_argument);  // no drive
  EXPECT_THROW(Compensator(Rig(), {.smoothing_rad_s = -0.1}), std::invalid_argument);
  EXPECT_THROW(Compensator(Rig(), {.pressure_filter_Hz = std::nan("")}), std::invalid_argument);
}

TEST(Compensator, ARecordedTorqueIsPlayedFromTheFirstStepOnAndHeldAtItsEnd) {
  CompensatorConfig config{.kind = CompensatorKind::kRecorded};
  config.recorded = {2.0 * kCycle_s, {0.1, 0.3, -0.1}};
  Compensator compensator(Rig(), config);
  for (int repeat = 0; repeat < 2; ++repeat) {
    for (const double expected_Nm : {0.1, 0.2, 0.3, 0.1, -0.1, -0.1, -0.1}) {
      EXPECT_NEAR(compensator.Step(kMoving, Measured(), kCycle_s), expected_Nm, kTolerance);
    }
    compensator.Reset();
  }
}

TEST(Compensator, ARecordedTorqueThatCannotBePlayedIsRefused) {
  CompensatorConfig config{.kind = CompensatorKind::kRecorded};
  EXPECT_THROW(Compensator(Rig(), config), std::invalid_argument);
  config.recorded = {kCycle_s, {}};
  EXPECT_THROW(Compensator(Rig(), config), std::invalid_argument);
  config.recorded = {kCycle_s, {0.0, NAN}};
  EXPECT_THROW(Compensator(Rig(), config), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::control
