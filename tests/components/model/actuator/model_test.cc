#include "components/model/actuator/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace sinew::actuator {
namespace {

JointModel Rig(std::initializer_list<const char*> added = {}) {
  JointModel model;
  model.name = "joint";
  model.constants = {.gear_ratio = 100.0,
                     .link_length_m = 0.3,
                     .gravity_m_s2 = 9.81,
                     .torque_constant_Nm_A = 0.0159155,
                     .force_constant_N_V = 0.0};
  for (const char* effect :
       {"drive_current", "rotor_inertia", "link_inertia", "declared_payload", "motor_viscous",
        "coulomb", "gravity", "pneumatic_torque", "pneumatic_stiffness", "load_force"}) {
    model.terms.push_back(MakeTerm(effect, model.constants));
  }
  const auto set = [&](const char* effect, double value) {
    model.terms[static_cast<std::size_t>(model.Find(effect))].linear[0].value = value;
  };
  set("rotor_inertia", 0.11);
  set("link_inertia", 0.02);
  set("motor_viscous", 0.3);
  set("coulomb", 0.2);
  set("gravity", 0.6);
  set("pneumatic_torque", 0.36);
  set("pneumatic_stiffness", 4.0);
  for (const char* effect : added) {
    model.terms.push_back(MakeTerm(effect, model.constants));
    model.terms.back().declared = false;
  }
  return model;
}

effects::JointSample Sample() {
  effects::JointSample x;
  x.position_rad = 0.3;
  x.velocity_rad_s = 0.7;
  x.acceleration_rad_s2 = 2.0;
  x.motor_velocity_rad_s = 69.0;
  x.motor_acceleration_rad_s2 = 210.0;
  x.pressure_bar = 4.0;
  x.load_force_N = 1.5;
  x.payload_kg = 0.5;
  x.drive_input = 3.0;
  return x;
}

// The balance of the rig, written out.
TEST(JointModel, AddsUpToTheBalanceOfTheRig) {
  const JointModel model = Rig();
  const effects::JointSample x = Sample();
  const double expected = 0.77 * 100.0 * 0.0159155 * 3.0 - 0.11 * 2.1 - (0.02 + 0.5 * 0.09) * 2.0 -
                          0.3 * 0.69 - 0.2 - (0.6 + 0.5 * 9.81 * 0.3) * std::cos(0.3) + 0.36 * 4.0 -
                          4.0 * 4.0 * 0.3 - 0.3 * 1.5;
  EXPECT_NEAR(model.Residual(x, {}), expected, 1e-12);
  double sum = 0.0;
  for (int i = 0; i < static_cast<int>(model.terms.size()); ++i) sum += model.TermTorque(i, x, {});
  EXPECT_NEAR(sum, expected, 1e-12);
  EXPECT_NEAR(model.SideTorque(effects::Side::kMotor, x, {}) +
                  model.SideTorque(effects::Side::kOutput, x, {}),
              expected, 1e-12);
}

TEST(JointModel, NeedsTheDriveTorqueAtWhichNothingRemains) {
  for (const JointModel& model :
       {Rig(), Rig({"load_dependent_friction", "torque_constant_saturation"})}) {
    JointModel strong = model;
    if (strong.terms.size() > 10) {
      strong.terms[10].linear[0].value = 0.15;
      strong.terms[11].linear[0].value = 1e-4;
    }
    effects::JointSample x = Sample();
    const double torque = strong.RequiredDriveTorque(x, {});
    x.drive_input = strong.RequiredDriveInput(x, {});
    EXPECT_NEAR(strong.Residual(x, {}), 0.0, 1e-9);
    EXPECT_NEAR(strong.Torque(effects::Role::kDrive, x, {}), torque, 1e-9);
    // What x says of the drive does not matter.
    effects::JointSample other = x;
    other.drive_input = -17.0;
    EXPECT_EQ(strong.RequiredDriveTorque(other, {}), torque);
  }
}

// N Kt (0.77 I - s I^3) has its maximum at I = sqrt(0.77 / 3 s).
TEST(JointModel, ADriveThatSaturatesIsAskedForWhatItCanGive) {
  JointModel model = Rig({"torque_constant_saturation"});
  constexpr double kSaturation = 0.01;
  model.terms.back().linear[0].value = kSaturation;
  const double peak = std::sqrt(0.77 / (3.0 * kSaturation));
  effects::JointSample x = Sample();
  bool reached = false;
  // Where the fixed point does not converge any more.
  for (const double input : {0.5 * peak, 0.9 * peak, -0.99 * peak}) {
    x.acceleration_rad_s2 = x.motor_acceleration_rad_s2 = 0.0;
    x.drive_input = input;
    x.load_force_N = 0.0;
    const double alone = model.Residual(x, {});
    x.load_force_N = 1.0;
    x.load_force_N = alone / (alone - model.Residual(x, {}));  // the hand closes the balance
    x.drive_input = 0.0;
    EXPECT_NEAR(model.RequiredDriveInput(x, {}, &reached), input, 1e-5 * peak);
    EXPECT_TRUE(reached);
  }
  x.load_force_N += 1000.0;
  const double most = model.RequiredDriveInput(x, {}, &reached);
  EXPECT_FALSE(reached);
  EXPECT_TRUE(std::isfinite(most));
  EXPECT_LT(std::abs(most), 1e3 * peak);
}

TEST(JointModel, KeepsTheMemoryOfEachTermApart) {
  JointModel model = Rig({"seal_hysteresis", "seal_hysteresis"});
  model.terms[10].linear[0].value = 0.1;
  model.terms[11].linear[0].value = 0.1;
  model.terms[10].nonlinear[0].value = 0.01;
  model.terms[11].nonlinear[0].value = 0.1;
  ASSERT_EQ(model.memory_size(), 4);
  std::vector<double> memory(4);
  effects::JointSample x = Sample();
  model.ResetMemory(x, memory);
  EXPECT_EQ(model.TermTorque(10, x, memory), 0.0);
  x.position_rad += 0.02;
  model.Advance(x, 1e-3, memory);
  EXPECT_NEAR(model.TermTorque(10, x, memory), -0.1 * 4.0 * (1.0 - std::exp(-2.0)), 1e-12);
  EXPECT_NEAR(model.TermTorque(11, x, memory), -0.1 * 4.0 * (1.0 - std::exp(-0.2)), 1e-12);
}

TEST(JointModel, FindsParametersByNameAndNamesWhatItLacks) {
  const JointModel model = Rig();
  EXPECT_EQ(model.Parameter("gravity", "gravity_torque"), 0.6);
  EXPECT_EQ(model.Parameter("pneumatic_stiffness", "rest_angle"), 0.0);
  EXPECT_EQ(model.Find("stribeck"), -1);
  try {
    static_cast<void>(model.Parameter("stribeck", "stribeck"));
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'stribeck'"), std::string::npos);
  }
}

TEST(JointModel, SaysNothingFiniteAboutNonFiniteInput) {
  const JointModel model = Rig();
  effects::JointSample x = Sample();
  x.velocity_rad_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(model.Residual(x, {})));
  EXPECT_FALSE(std::isfinite(model.RequiredDriveTorque(x, {})));
}

TEST(PhysicalValue, DividesWhatIsRelativeToTheDriveByItsFactor) {
  JointModel model = Rig({"transport_delay", "stribeck"});
  model.terms[10].linear[0].value = 0.77e-3;
  model.terms[11].linear[0].value = 0.5;
  EXPECT_NEAR(PhysicalValue(model, 10, 0), 1e-3, 1e-15);
  EXPECT_EQ(PhysicalValue(model, 11, 0), 0.5);
  EXPECT_THROW(static_cast<void>(PhysicalValue(model, 12, 0)), std::out_of_range);
}

// A parameter relative to the drive is divided by the drive's factor, and so is its interval.
TEST(PhysicalTerm, ScalesTheIntervalWithTheValue) {
  JointModel model = Rig({"transport_delay"});
  model.terms[10].linear[0].value = 0.77e-3;
  model.terms[10].linear[0].half_width_95 = 0.077e-3;
  const Term physical = PhysicalTerm(model, 10);
  EXPECT_NEAR(physical.linear[0].value, 1e-3, 1e-15);
  ASSERT_TRUE(physical.linear[0].half_width_95.has_value());
  EXPECT_NEAR(*physical.linear[0].half_width_95, 0.1e-3, 1e-15);
}

TEST(JointModel, FindsTheSecondNonlinearParameterByItsName) {
  JointModel model = Rig({"external_bump"});
  model.terms.back().nonlinear[0].value = 3.0;
  model.terms.back().nonlinear[1].value = 0.25;
  const auto& names = model.terms.back().effect->info().nonlinear;
  EXPECT_EQ(model.Parameter("external_bump", names[0].name), 3.0);
  EXPECT_EQ(model.Parameter("external_bump", names[1].name), 0.25);
}

// Friction that grows with the load reads the torque behind the declared friction.
TEST(RemakeEffects, LoadIsWhatFrictionLeaves) {
  JointModel model = Rig({"load_dependent_friction"});
  model.terms[static_cast<std::size_t>(model.Find("drive_current"))].linear[0].value = 0.5;
  RemakeEffects(&model);
  model.terms.back().linear[0].value = 1.0;
  const effects::JointSample x = Sample();
  const int last = static_cast<int>(model.terms.size()) - 1;
  // By the ideal drive, twice as strong as the one of efficiency 0.5.
  const double load = 100.0 * 0.0159155 * 3.0 - (0.2 + 0.3 * 0.7) / 0.5;
  EXPECT_NEAR(model.TermTorque(last, x, {}), -load, 1e-12);
  // Against the motion it is larger than the drive.
  effects::JointSample back = x;
  back.velocity_rad_s = -0.7;
  EXPECT_NEAR(model.TermTorque(last, back, {}), 100.0 * 0.0159155 * 3.0 + (0.2 + 0.3 * 0.7) / 0.5,
              1e-12);
}

// The drive of a gear whose both torques are measured is the load itself.
TEST(RemakeEffects, BetweenTwoTorqueSensorsTheDriveIsTheLoad) {
  JointModel model = Rig({"load_dependent_friction"});
  model.terms[0] = MakeTerm("drive_torque", model.constants);
  RemakeEffects(&model);
  EXPECT_EQ(model.constants.drive_coulomb_Nm, 0.0);
  std::erase_if(model.terms,
                [](const Term& term) { return term.effect->info().name == "load_force"; });
  RemakeEffects(&model);
  EXPECT_EQ(model.constants.drive_coulomb_Nm, 0.2);
}

// Terms of other balances stand in the same file and leave this one as it is.
TEST(JointModel, ItsResidualIsThatOfItsOwnBalance) {
  JointModel model = Rig();
  effects::JointSample x = Sample();
  x.tooth_torque_Nm = 2.0;
  x.tooth_side = 1.0;
  const double alone = model.Residual(x, {});
  model.terms.push_back(MakeTerm("gear_compliance", model.constants, effects::Balance::kKinematic));
  model.terms.back().linear[0].value = 5.0;
  ASSERT_NE(model.TermTorque(static_cast<int>(model.terms.size()) - 1, x, {}), 0.0);
  EXPECT_EQ(model.Residual(x, {}), alone);
}

}  // namespace
}  // namespace sinew::actuator
