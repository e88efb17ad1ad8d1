#include "sim/surrogate/excitation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/gravity.h"

namespace sinew::surrogate {
namespace {

using types::kTwoPi;
constexpr double kBridge_s = 1.5;  // from one centre to the next
constexpr std::uint64_t kStreamPlan = 300;

// The operator's nominal values of the rig.
constexpr double kGearRatio = 100.0;
constexpr double kEfficiency = 0.77;
constexpr double kInertia_kg_m2 = 0.134;
constexpr double kViscous_Nm_s_rad = 0.31;
constexpr double kCoulomb_Nm = 0.2;
constexpr double kGravity_Nm = 0.58;
constexpr double kStiffness_Nm_rad = 60.0;
constexpr double kDamping_Nm_s_rad = 5.0;
constexpr double kTorqueLimit_Nm = 0.3;  // motor shaft
constexpr double kPressureBand_bar = 0.05;

// 0 to 1 without a jump in velocity or acceleration.
double Smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

double Window(double local_s, double length_s, double edge_s) {
  return Smooth(local_s / edge_s) * Smooth((length_s - local_s) / edge_s);
}

// The piece of a plan at a time: the last that has begun, before the first the first.
template <class Piece>
const Piece& PieceAt(const std::vector<Piece>& plan, double time_s) {
  const auto after = std::upper_bound(plan.begin(), plan.end(), time_s,
                                      [](double t, const Piece& p) { return t < p.start_s; });
  return after == plan.begin() ? plan.front() : *std::prev(after);
}

}  // namespace

ExcitationKind ParseExcitation(std::string_view text) {
  if (text == "designed") return ExcitationKind::kDesigned;
  if (text == "task") return ExcitationKind::kTask;
  if (text == "sea") return ExcitationKind::kSea;
  if (text == "pea") return ExcitationKind::kPea;
  throw std::invalid_argument("excitation '" + std::string(text) +
                              "' is not known, expected designed, task, sea or pea");
}

std::vector<Excitation::Sine> Excitation::MakeSines(RandomStream* random, int count,
                                                    double lowest_Hz, double highest_Hz,
                                                    double slope) {
  std::vector<Sine> sines;
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const double place = (i + random->Uniform(0.15, 0.85)) / count;
    Sine sine;
    sine.frequency_Hz = lowest_Hz * std::pow(highest_Hz / lowest_Hz, place);
    sine.amplitude = std::pow(sine.frequency_Hz, -slope);
    sine.phase_rad = random->Uniform(0.0, kTwoPi);
    sum += sine.amplitude * sine.amplitude;
    sines.push_back(sine);
  }
  // Root mean square of the sum is 0.45: peaks seldom pass 1, and ShapeValue limits them.
  for (Sine& sine : sines) sine.amplitude *= 0.45 * std::numbers::sqrt2 / std::sqrt(sum);
  return sines;
}

Excitation::Excitation(const ExcitationParameters& parameters) : parameters_(parameters) {
  const ExcitationParameters& p = parameters_;
  if (!(p.duration_s > 0.0) || !(p.largest_angle_rad > 0.0) || !(p.largest_angle_rad < 2.0) ||
      !(p.largest_hand_N >= 0.0) || !(p.lowest_pressure_bar >= 0.0) ||
      !(p.highest_pressure_bar >= p.lowest_pressure_bar) || !(p.payload_kg >= 0.0)) {
    throw std::invalid_argument("excitation: duration, angle, force and pressures must make sense");
  }
  RandomStream random(p.seed, kStreamPlan);
  if (p.kind == ExcitationKind::kDesigned) {
    PlanDesigned(&random);
    PlanPressure(&random);
    return;
  }
  pressure_ = {{0.0, p.kind == ExcitationKind::kSea ? 6.0 : 4.0, true}};
  if (p.kind == ExcitationKind::kTask) {
    PlanTask(&random);
  } else {
    Add({.shape = Shape::kRest, .length_s = p.duration_s});
    PlanStrokes(&random);
  }
}

double Excitation::Planned_s() const {
  if (segments_.empty()) return 0.0;
  return segments_.back().start_s + (segments_.back().length_s + kBridge_s);
}

void Excitation::Add(Segment segment) {
  segment.start_s = Planned_s();
  segments_.push_back(std::move(segment));
}

void Excitation::PlanTask(RandomStream* random) {
  Add({.shape = Shape::kRest, .length_s = 1.0});
  while (Planned_s() < parameters_.duration_s) {
    Add({.shape = Shape::kMultisine,
         .length_s = 10.0,
         .amplitude_rad = std::numbers::pi / 6.0,
         .sines = {{1.0, 0.4, 0.0}}});
    Add({.shape = Shape::kRest, .length_s = random->Uniform(0.5, 1.5)});
  }
}

void Excitation::PlanDesigned(RandomStream* random) {
  enum { kSines, kChirp, kRamps, kSlowRamps, kPause };
  constexpr int kOrder[] = {kSines, kSines, kRamps, kChirp, kSlowRamps,
                            kSines, kPause, kChirp, kRamps, kSlowRamps};
  auto next = static_cast<std::size_t>(random->Uniform(0.0, std::size(kOrder)));
  Add({.shape = Shape::kRest, .length_s = random->Uniform(1.5, 3.0)});
  bool hand = random->Uniform() < 0.5;
  for (; Planned_s() < parameters_.duration_s; ++next) {
    Segment segment;
    segment.centre_rad = random->Uniform(-0.25, 0.25);
    switch (kOrder[next % std::size(kOrder)]) {
      case kSines:
        segment.shape = Shape::kMultisine;
        segment.length_s = random->Uniform(11.0, 15.0);
        segment.amplitude_rad = parameters_.largest_angle_rad - std::abs(segment.centre_rad);
        segment.sines = MakeSines(random, 7, 0.1, 1.7, 0.8);
        break;
      case kChirp:
        segment.shape = Shape::kChirp;
        segment.length_s = random->Uniform(9.0, 12.0);
        segment.amplitude_rad = random->Uniform(0.4, 0.6);
        segment.start_Hz = 0.15;
        segment.end_Hz = random->Uniform(1.8, 2.6);
        break;
      case kRamps:
        segment.shape = Shape::kTriangle;
        segment.length_s = random->Uniform(8.0, 11.0);
        segment.amplitude_rad = random->Uniform(0.35, 0.5);
        segment.start_Hz = random->Uniform(0.15, 0.55);  // 0.2 to 1.1 rad/s
        break;
      case kSlowRamps:
        segment.shape = Shape::kTriangle;
        segment.length_s = random->Uniform(12.0, 15.0);
        segment.amplitude_rad = random->Uniform(0.13, 0.2);
        segment.start_Hz = 1.0 / segment.length_s;  // about 0.05 rad/s
        break;
      default:
        segment.shape = Shape::kRest;
        segment.length_s = random->Uniform(2.5, 4.0);
        break;
    }
    const bool slow = segment.shape == Shape::kRest || segment.amplitude_rad < 0.25;
    if (!slow) {
      if (hand) {
        segment.hand_N = parameters_.largest_hand_N * random->Uniform(0.6, 1.0);
        segment.hand_sines = MakeSines(random, 4, 0.15, 1.1, 0.5);
      }
      hand = !hand;
    }
    Add(std::move(segment));
  }
}

void Excitation::PlanPressure(RandomStream* random) {
  const double lowest_bar = parameters_.lowest_pressure_bar;
  const double highest_bar = parameters_.highest_pressure_bar;
  const double middle_bar = 0.5 * (lowest_bar + highest_bar);
  double time_s = 0.0;
  while (time_s < parameters_.duration_s) {
    PressureStep step{.start_s = time_s};
    step.target_bar = pressure_.empty() ? random->Uniform(middle_bar - 1.0, middle_bar + 1.0)
                                        : random->Uniform(lowest_bar, highest_bar);
    time_s += random->Uniform(7.0, 12.0);
    pressure_.push_back(step);
    if (random->Uniform() < 0.5) {
      step.start_s = time_s;
      step.valve_open = false;
      time_s += random->Uniform(4.0, 7.0);
      pressure_.push_back(step);
    }
  }
}

void Excitation::PlanStrokes(RandomStream* random) {
  double time_s = 1.0;
  while (time_s < parameters_.duration_s) {
    Stroke stroke{.start_s = time_s};
    if (parameters_.kind == ExcitationKind::kSea) {
      // A person keeps time and force to about a tenth.
      stroke.length_s = 0.5 * (1.0 + 0.08 * std::tanh(random->Gaussian()));
      stroke.size = 11.0 * (1.0 + 0.1 * std::tanh(random->Gaussian()));
    } else {
      stroke.length_s = 3.5 * (1.0 + 0.15 * std::tanh(random->Gaussian()));
      stroke.size = std::numbers::pi * (1.0 - 0.04 * random->Uniform());
    }
    time_s += stroke.length_s;
    strokes_.push_back(stroke);
  }
}

double Excitation::PeaHand_N(double time_s, const provider::PlantSensors& sensors) const {
  // The hand goes down and back as a raised cosine and pushes like a soft spring; it cannot pull.
  constexpr double kHand_N_rad = 150.0;
  constexpr double kHandLimit_N = 60.0;
  const double behind_rad = sensors.position_rad[0] - Reference_rad(time_s);
  return std::clamp(kHand_N_rad * behind_rad, 0.0, kHandLimit_N);
}

void Excitation::Prepare(RigParameters* rig) const {
  rig->pneumatics.initial_pressure_bar = initial_pressure_bar();
  rig->pneumatics.initial_valve_open = true;
  if (parameters_.kind == ExcitationKind::kSea) {
    rig->rotor_locked = true;
    rig->initial_angle_rad = 0.0;
  } else if (parameters_.kind == ExcitationKind::kPea) {
    rig->initial_angle_rad = 0.5 * std::numbers::pi;
  }
}

double Excitation::ShapeValue(const Segment& segment, double local_s) {
  switch (segment.shape) {
    case Shape::kMultisine: {
      double sum = 0.0;
      for (const Sine& sine : segment.sines) {
        sum += sine.amplitude * std::sin(kTwoPi * sine.frequency_Hz * local_s + sine.phase_rad);
      }
      // Smooth limit at +-1.15.
      return segment.amplitude_rad * 1.15 * std::tanh(sum / 1.15) *
             Window(local_s, segment.length_s, 1.0);
    }
    case Shape::kChirp: {
      const double rate = std::log(segment.end_Hz / segment.start_Hz) / segment.length_s;
      const double phase_rad = kTwoPi * segment.start_Hz * std::expm1(rate * local_s) / rate;
      const double shrink =
          std::pow(segment.start_Hz / segment.end_Hz, 0.45 * local_s / segment.length_s);
      return segment.amplitude_rad * shrink * std::sin(phase_rad) *
             Window(local_s, segment.length_s, 1.0);
    }
    case Shape::kTriangle: {
      constexpr double kRounding = 0.995;
      const double swing = std::asin(kRounding * std::sin(kTwoPi * segment.start_Hz * local_s));
      return segment.amplitude_rad * swing / std::asin(kRounding) *
             Window(local_s, segment.length_s, 0.5);
    }
    case Shape::kRest:
      return 0.0;
  }
  return 0.0;
}

double Excitation::Reference_rad(double time_s) const {
  if (parameters_.kind == ExcitationKind::kPea) {
    constexpr double kUpright_rad = 0.5 * std::numbers::pi;
    const Stroke& stroke = PieceAt(strokes_, time_s);
    const double local_s = time_s - stroke.start_s;
    if (local_s < 0.0 || local_s > stroke.length_s) return kUpright_rad;
    return kUpright_rad - 0.5 * stroke.size * (1.0 - std::cos(kTwoPi * local_s / stroke.length_s));
  }
  const Segment& segment = PieceAt(segments_, time_s);
  const double local_s = time_s - segment.start_s;
  if (local_s <= segment.length_s) return segment.centre_rad + ShapeValue(segment, local_s);
  const bool last = &segment == &segments_.back();
  const double next_rad = last ? segment.centre_rad : (&segment + 1)->centre_rad;
  return segment.centre_rad +
         (next_rad - segment.centre_rad) * Smooth((local_s - segment.length_s) / kBridge_s);
}

double Excitation::Hand_N(double time_s) const {
  if (parameters_.kind == ExcitationKind::kSea) {
    const Stroke& stroke = PieceAt(strokes_, time_s);
    const double local_s = time_s - stroke.start_s;
    if (local_s < 0.0 || local_s > stroke.length_s) return 0.0;
    // Pushes for a little over half of the stroke.
    return stroke.size * std::max(0.0, std::sin(kTwoPi * local_s / stroke.length_s) + 0.1) / 1.1;
  }
  const Segment& segment = PieceAt(segments_, time_s);
  const double local_s = time_s - segment.start_s;
  if (segment.hand_N == 0.0 || local_s > segment.length_s) return 0.0;
  double sum = 0.3;  // a hand rather rests than lifts
  for (const Sine& sine : segment.hand_sines) {
    sum += sine.amplitude * std::sin(kTwoPi * sine.frequency_Hz * local_s + sine.phase_rad);
  }
  return segment.hand_N * sum * Window(local_s, segment.length_s, 1.0);
}

void Excitation::operator()(double time_s, const provider::PlantSensors& sensors,
                            provider::PlantCommand* command,
                            provider::Disturbance* disturbance) const {
  if (parameters_.kind == ExcitationKind::kSea) {
    disturbance->hand_force_N[0] = Hand_N(time_s);
    command->valve_open[0] = true;
    command->vent_open[0] = true;  // the controlled leak
    return;
  }
  if (parameters_.kind == ExcitationKind::kPea) {
    // 1.54 N·m at the output: with the chamber's 1.4 it brings the link up against gravity and
    // friction.
    command->mode[0] = types::ControlMode::kTorque;
    command->motor_torque_Nm[0] = 0.02;
    disturbance->hand_force_N[0] = PeaHand_N(time_s, sensors);
    command->valve_open[0] = true;
    return;
  }
  constexpr double kStep_s = 1e-3;
  const double reference_rad = Reference_rad(time_s);
  const double before_rad = Reference_rad(time_s - kStep_s);
  const double after_rad = Reference_rad(time_s + kStep_s);
  const double velocity_rad_s = (after_rad - before_rad) / (2.0 * kStep_s);
  const double acceleration_rad_s2 =
      (after_rad - 2.0 * reference_rad + before_rad) / (kStep_s * kStep_s);

  const double arm_kg_m = parameters_.payload_kg * 0.3;
  const double forward_Nm =
      (kInertia_kg_m2 + arm_kg_m * 0.3) * acceleration_rad_s2 + kViscous_Nm_s_rad * velocity_rad_s +
      kCoulomb_Nm * std::tanh(velocity_rad_s / 0.03) +
      (kGravity_Nm + arm_kg_m * types::kGravity_m_s2) * std::cos(reference_rad) -
      (parameters_.pneumatic_Nm_bar - parameters_.pneumatic_stiffness_Nm_rad_bar * reference_rad) *
          sensors.chamber_pressure_bar[0];
  const double feedback_Nm =
      kStiffness_Nm_rad * (reference_rad - sensors.motor_position_rad[0] / kGearRatio) +
      kDamping_Nm_s_rad * (velocity_rad_s - sensors.motor_velocity_rad_s[0] / kGearRatio);
  command->mode[0] = types::ControlMode::kTorque;
  command->motor_torque_Nm[0] = std::clamp((forward_Nm + feedback_Nm) / (kGearRatio * kEfficiency),
                                           -kTorqueLimit_Nm, kTorqueLimit_Nm);
  disturbance->hand_force_N[0] = Hand_N(time_s);

  const PressureStep& step = PieceAt(pressure_, time_s);
  const double reservoir_bar = sensors.reservoir_pressure_bar[0];
  command->valve_open[0] = step.valve_open;
  command->compressor_on[0] = reservoir_bar < step.target_bar - kPressureBand_bar;
  command->vent_open[0] = reservoir_bar > step.target_bar + kPressureBand_bar;
}

}  // namespace sinew::surrogate
