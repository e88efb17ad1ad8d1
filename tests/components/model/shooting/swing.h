// Recordings of a pendulum from the plant, with steps five times finer than those of a fit:
// released to swing freely, or pushed by a slow torque so that it sticks and slips. Angles are
// rounded to an encoder's counts and have its noise. Fixed seeds.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "components/base/types/run.h"
#include "components/model/identify/processing.h"
#include "sim/plant/single_joint.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::shooting {

inline constexpr double kInertia_kg_m2 = 0.14, kGravity_Nm = 3.0, kCoulomb_Nm = 0.04,
                        kViscous_Nm_s_rad = 0.02;

// Angle 0 is horizontal, the pendulum hangs at -pi / 2.
inline actuator::JointModel Pendulum() {
  actuator::JointModel model;
  model.name = "pendulum";
  const auto add = [&](const std::string& effect, double value, double tolerance) {
    model.terms.push_back(identify::TermOf(effect, {value}, model.constants, tolerance));
  };
  add("drive_torque", 1.0, 0.0);
  model.terms.back().linear[0].fixed = true;
  add("inertia", kInertia_kg_m2, 0.1);
  add("gravity", kGravity_Nm, 0.1);
  add("viscous", kViscous_Nm_s_rad, 1.0);
  add("coulomb", kCoulomb_Nm, 1.0);
  return model;
}

// A wrong declaration, within its tolerances.
inline actuator::JointModel Declared() {
  actuator::JointModel model = Pendulum();
  model.terms[1].linear[0].value *= 1.08;
  model.terms[2].linear[0].value *= 0.95;
  model.terms[3].linear[0].value *= 1.5;
  model.terms[4].linear[0].value *= 0.6;
  return model;
}

struct Motion {
  double duration_s = 16.0;
  double release_rad = 1.2;  // from where it hangs, at rest
  double torque_Nm = 0.0;    // amplitude of three sines about `slow_Hz`; 0: it swings freely
  double slow_Hz = 0.1;
  std::uint64_t seed = 1;
};

inline types::Run Swing(const actuator::JointModel& truth, const Motion& motion) {
  constexpr double kRate_Hz = 200.0;
  constexpr double kStep_s = 1e-4;
  constexpr double kCount_rad = 2.0 * M_PI / 16384.0, kNoise_rad = 3e-4;
  plant::SingleJoint joint(truth, {});
  joint.Reset(-M_PI / 2 + motion.release_rad);
  std::mt19937_64 random(motion.seed);
  std::normal_distribution<double> noise(0.0, kNoise_rad);
  std::uniform_real_distribution<double> any(0.0, 2.0 * M_PI);
  const double phase[] = {any(random), any(random), any(random)};
  types::Run run;
  run.name = "swing_" + std::to_string(motion.seed);
  run.content_hash = run.name;
  const auto n = static_cast<Eigen::Index>(motion.duration_s * kRate_Hz);
  Eigen::VectorXd angle(n), torque(n);
  run.time_s.resize(n);
  plant::DriveCommand command;
  command.mode = types::ControlMode::kTorque;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / kRate_Hz;
    run.time_s[i] = t;
    angle[i] = kCount_rad * std::round((joint.position_rad() + noise(random)) / kCount_rad);
    double push = 0.0;
    for (int k = 0; k < 3; ++k) {
      push += std::sin(2.0 * M_PI * motion.slow_Hz * (1.0 + 0.62 * k) * t + phase[k]) / (1.0 + k);
    }
    torque[i] = motion.torque_Nm * push;
    command.motor_torque_Nm = torque[i];
    joint.plant().SetCommand(command);
    for (int k = 0; k < static_cast<int>(std::lround(1.0 / kRate_Hz / kStep_s)); ++k) {
      joint.Step(kStep_s);
    }
  }
  run.signals[types::Signal::kPosition] = angle;
  run.signals[types::Signal::kTorque] = torque;
  return run;
}

}  // namespace sinew::shooting
