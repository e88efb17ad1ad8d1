// Recordings with a known answer: a joint that follows a sum of sines, the drive that a given model
// needs for it, and noise. Fixed seeds.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

inline actuator::Term TermOf(const std::string& effect, std::vector<double> linear,
                             const effects::JointConstants& constants, double tolerance = 0.15) {
  actuator::Term term = actuator::MakeTerm(effect, constants);
  for (std::size_t i = 0; i < linear.size(); ++i) {
    term.linear[i].value = linear[i];
    term.linear[i].tolerance = tolerance;
  }
  return term;
}

// A rotary joint with gravity and a load cell: the known force sets the scale of the drive.
inline actuator::JointModel SyntheticModel() {
  actuator::JointModel model;
  model.name = "joint";
  model.constants.gear_ratio = 50.0;
  model.constants.torque_constant_Nm_A = 0.02;
  model.constants.link_length_m = 0.4;
  const auto add = [&](const std::string& effect, double value) {
    model.terms.push_back(TermOf(effect, {value}, model.constants));
  };
  add("drive_current", 0.8);
  add("inertia", 0.3);
  add("viscous", 0.5);
  add("coulomb", 0.4);
  add("gravity", 1.5);
  add("load_force", 1.0);
  model.terms.back().linear[0].fixed = true;
  return model;
}

struct Recipe {
  double rate_Hz = 200.0;
  double duration_s = 60.0;
  std::uint64_t seed = 1;
  double noise_A = 0.02;        // standard deviation of the current's noise
  double noise_memory = 0.0;    // autoregression of the noise, 0: white
  double load_N = 3.0;          // amplitude of the load cell's force
  double slowness = 1.0;        // of the motion: its frequencies are divided by it
  bool motor_position = false;  // recorded as well
};

inline types::Run SyntheticRun(const actuator::JointModel& truth, const Recipe& recipe) {
  types::Run run;
  run.name = "synthetic_" + std::to_string(recipe.seed);
  run.kind = truth.kind;
  const auto n = static_cast<Eigen::Index>(recipe.rate_Hz * recipe.duration_s);
  std::mt19937_64 random(recipe.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * M_PI);
  constexpr double kFrequency_Hz[] = {0.11, 0.23, 0.41, 0.67, 1.03, 1.37};
  constexpr double kAmplitude_rad[] = {0.5, 0.35, 0.2, 0.12, 0.05, 0.03};
  double phases[6];
  for (double& p : phases) p = phase(random);
  const double force_phase = phase(random);
  Eigen::VectorXd q(n), force(n), current(n);
  run.time_s.resize(n);
  std::vector<double> memory(static_cast<std::size_t>(truth.memory_size()));
  double noise = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / recipe.rate_Hz;
    effects::JointSample x;
    x.time_s = t;
    for (int k = 0; k < 6; ++k) {
      const double w = 2.0 * M_PI * kFrequency_Hz[k] / recipe.slowness;
      const double a = kAmplitude_rad[k];
      x.position_rad += a * std::sin(w * t + phases[k]);
      x.velocity_rad_s += a * w * std::cos(w * t + phases[k]);
      x.acceleration_rad_s2 -= a * w * w * std::sin(w * t + phases[k]);
      x.jerk_rad_s3 -= a * w * w * w * std::cos(w * t + phases[k]);
    }
    x.motor_position_rad = truth.constants.gear_ratio * x.position_rad;
    x.motor_velocity_rad_s = truth.constants.gear_ratio * x.velocity_rad_s;
    x.motor_acceleration_rad_s2 = truth.constants.gear_ratio * x.acceleration_rad_s2;
    x.load_force_N = recipe.load_N * std::sin(2.0 * M_PI * 0.31 * t + force_phase);
    if (i == 0) {
      truth.ResetMemory(x, memory);
    } else {
      truth.Advance(x, 1.0 / recipe.rate_Hz, memory);
    }
    noise =
        recipe.noise_memory * noise + std::sqrt(1.0 - recipe.noise_memory * recipe.noise_memory) *
                                          recipe.noise_A * normal(random);
    run.time_s[i] = t;
    q[i] = x.position_rad;
    force[i] = x.load_force_N;
    current[i] = truth.RequiredDriveInput(x, memory) + noise;
  }
  run.signals[types::Signal::kPosition] = q;
  if (recipe.motor_position) {
    run.signals[types::Signal::kMotorPosition] = truth.constants.gear_ratio * q;
  }
  run.signals[types::Signal::kLoadForce] = force;
  run.signals[types::Signal::kMotorCurrent] = current;
  run.content_hash = run.name;
  return run;
}

inline ProcessingOptions SyntheticProcessing() {
  ProcessingOptions options;
  options.state_cutoff_Hz = 30.0;
  options.parallel_cutoff_Hz = 8.0;
  options.rest_velocity = 0.05;
  return options;
}

inline Design MakeDesign(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                         const ProcessingOptions& options = SyntheticProcessing()) {
  return Design(MakeStates(runs, model, options), options);
}

}  // namespace sinew::identify
