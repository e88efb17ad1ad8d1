#include "bench/rigs/drawn/motion.h"

#include <algorithm>
#include <cmath>

#include "bench/rigs/drawn/random.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {
using types::kPi;
constexpr double kPressureSpell_s = 0.6;  // valve open after a step of pressure
}  // namespace

const char* WordOf(Excitation excitation) {
  switch (excitation) {
    case Excitation::kDesigned:
      return "designed";
    case Excitation::kTask:
      return "task";
    case Excitation::kLocked:
      return "locked";
  }
  return "";
}

Motion::Motion(const Rig& rig, Excitation excitation, int recording) {
  Random random(rig.number, 1000 + 10 * static_cast<int>(excitation) + recording);
  Random task(rig.number, 900);  // waypoints of the task are the same in every recording
  recording_ = recording;
  locked_ = excitation == Excitation::kLocked;
  centre_ = rig.centre;
  amplitude_ = rig.amplitude;
  duration_s_ = rig.rows / rig.rate_Hz;
  ambient_degC_ = random.Uniform(20.0, 25.0);
  start_degC_ = ambient_degC_ + random.Uniform(0.0, 12.0);
  fade_s_ = 0.7 / rig.frequency_Hz;
  const bool held_out = recording == kRecordings - 1;
  if (locked_) {
    for (int i = 0; i < 5; ++i) {
      hand_.push_back({0.16 * rig.play * random.Uniform(0.5, 1.0),
                       2.0 * kPi * random.Uniform(0.8, 3.0), 2.0 * kPi * random.Uniform()});
    }
    pressures_ = {rig.pressure_max_bar};
    return;
  }

  if (excitation == Excitation::kDesigned) {
    DrawDesigned(rig, held_out, random);
    payload_kg_ = rig.payloads && recording % 2 == 1 ? rig.payload_kg : 0.0;
  } else {
    parts_.push_back(DrawTask(rig, held_out, task, random));
    pressures_ = {rig.pressure_max_bar * task.Uniform(0.4, 0.8)};
    payload_kg_ = rig.payloads ? rig.payload_kg * 0.7 : 0.0;
  }
}

void Motion::DrawDesigned(const Rig& rig, bool held_out, Random& random) {
  // Shares of the time; the held-out recording has them in another order and proportion.
  std::vector<std::pair<Piece, double>> plan = {{kFast, 0.24},  {kSweep, 0.14}, {kSlow, 0.22},
                                                {kCreep, 0.12}, {kStop, 0.10},  {kAgain, 0.18}};
  if (held_out) {
    plan = {{kSlow, 0.25}, {kAgain, 0.30}, {kCreep, 0.10}, {kStop, 0.09}, {kFast, 0.26}};
  }
  double t = 0.0;
  for (const auto& [piece, share] : plan) {
    const double begin = t;
    t += share * duration_s_;
    parts_.push_back(DrawPart(rig, piece, begin, t, held_out, random));
  }
  const int levels = 6;
  for (int i = 0; i < levels; ++i) {
    pressures_.push_back(rig.pressure_max_bar * random.Uniform(0.05, 1.0));
  }
  if (!rig.load_cell) return;
  double at = random.Uniform(0.05, 0.1) * duration_s_;
  while (at < 0.95 * duration_s_) {
    const double length = random.LogUniform(0.3, 1.5) / rig.frequency_Hz;
    pushes_.push_back({at, length, rig.hand_N * random.Uniform(0.3, 1.0) * random.Sign()});
    at += length + random.Uniform(0.02, 0.1) * duration_s_;
  }
}

Motion::Part Motion::DrawPart(const Rig& rig, Piece piece, double begin, double end, bool held_out,
                              Random& random) const {
  Part part;
  part.begin = begin;
  part.end = end;
  const double f = rig.frequency_Hz * (held_out ? 0.8 : 1.0);
  if (piece == kFast || piece == kAgain) {
    const int count = random.Integer(5, 8);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      const double hz =
          f * (piece == kFast ? random.LogUniform(0.3, 2.2) : random.LogUniform(0.15, 1.2));
      const double size = std::min(1.0, f / hz) * random.Uniform(0.5, 1.0);
      part.sines.push_back({size, 2.0 * kPi * hz, 2.0 * kPi * random.Uniform()});
      sum += size;
    }
    for (Sine& sine : part.sines) sine.amplitude *= 1.5 * amplitude_ / sum;
  } else if (piece == kSweep) {
    part.kind = Part::kChirp;
    part.low = 0.2 * f;
    part.high = 3.0 * f;
  } else if (piece == kStop) {
    part.kind = Part::kPoints;
    for (int i = 0; i < 3; ++i) part.points.push_back(random.Uniform(-0.7, 0.7));
    part.move = std::min(0.5 / rig.frequency_Hz, 0.4 * (part.end - part.begin) / 3.0);
    part.dwell = (part.end - part.begin) / 3.0 - part.move;
  } else {
    part.kind = Part::kRamps;
    part.low = -random.Uniform(0.6, 0.95);
    part.high = random.Uniform(0.6, 0.95);
    const double speed = rig.speed() * (piece == kSlow ? 0.25 : 0.06);
    part.period = 2.0 * (part.high - part.low) * amplitude_ / speed;
    const double fits = 0.5 * (part.end - part.begin);
    if (part.period > fits) {  // a shorter stroke, or the ramp is too fast to be slow
      part.high = part.low + 0.5 * fits * speed / amplitude_;
      part.period = fits;
    }
  }
  return part;
}

Motion::Part Motion::DrawTask(const Rig& rig, bool held_out, Random& task, Random& random) const {
  enum { kPlaces, kOneSine, kStrokes };
  const int kind = rig.number < kSecondDraw ? kPlaces : Random(rig.number, 901).Integer(0, 2);
  Part part;
  part.end = duration_s_;
  if (kind == kOneSine) {
    const double size = task.Uniform(0.6, 0.95) * (held_out ? 0.8 : 1.0);
    const double hz = rig.frequency_Hz * task.Uniform(0.4, 1.0) * (held_out ? 1.25 : 1.0);
    part.sines = {{size * amplitude_, 2.0 * kPi * hz * random.Uniform(0.9, 1.1), 0.0}};
    return part;
  }
  part.kind = Part::kPoints;
  if (kind == kStrokes) {
    const double far = task.Uniform(0.5, 0.95) * (held_out ? 0.8 : 1.0);
    part.points = {-far, far};
    const double speed = rig.speed() * task.LogUniform(0.06, 0.4) * (held_out ? 1.3 : 1.0);
    // Three strokes at least.
    part.dwell = task.Uniform(0.2, 1.0) / rig.frequency_Hz;
    part.move = std::min(2.0 * far * amplitude_ / speed, 0.3 * part.end - part.dwell);
    return part;
  }
  const int count = task.Integer(3, 5);
  for (int i = 0; i < count; ++i) part.points.push_back(task.Uniform(-0.9, 0.9));
  if (held_out) {
    for (double& point : part.points)
      point = std::clamp(point * 0.8 + random.Uniform(-0.15, 0.15), -0.95, 0.95);
  }
  part.move = task.Uniform(0.5, 1.0) / rig.frequency_Hz * (held_out ? 1.2 : 1.0);
  part.dwell = task.Uniform(0.2, 0.6) / rig.frequency_Hz;
  return part;
}

double Motion::Of(const Part& part, double t) const {
  const double s = t - part.begin;
  const double length = part.end - part.begin;
  switch (part.kind) {
    case Part::kSines: {
      double sum = 0.0;
      for (const Sine& sine : part.sines)
        sum += sine.amplitude * std::sin(sine.omega * s + sine.phase);
      return sum;
    }
    case Part::kChirp: {
      // Frequency rises exponentially, amplitude falls with it: constant speed.
      const double k = std::log(part.high / part.low) / length;
      const double phase = 2.0 * kPi * part.low * (std::exp(k * s) - 1.0) / k;
      const double hz = part.low * std::exp(k * s);
      return amplitude_ * std::min(0.9, 1.5 * part.low / hz + 0.1 * part.low / part.high) *
             std::sin(phase);
    }
    case Part::kRamps: {
      // A triangle with its corners rounded.
      constexpr double kRound = 0.99;
      const double wave =
          std::asin(-kRound * std::cos(2.0 * kPi * s / part.period)) / std::asin(kRound);
      const double up = 0.5 + 0.5 * wave;
      return amplitude_ * (part.low + (part.high - part.low) * up);
    }
    case Part::kPoints: {
      const double each = part.move + part.dwell;
      const int count = static_cast<int>(part.points.size());
      const int i = static_cast<int>(s / each);
      const double from = part.points[i % count], to = part.points[(i + 1) % count];
      const double u = std::min(1.0, (s - i * each) / part.move);
      // Trapezoid of velocity: a quarter up, half level, a quarter down.
      const double v = 4.0 / 3.0;
      double x;
      if (u < 0.25) {
        x = 2.0 * v * u * u;
      } else if (u < 0.75) {
        x = v * (u - 0.125);
      } else {
        x = 1.0 - 2.0 * v * (1.0 - u) * (1.0 - u);
      }
      return amplitude_ * (from + (to - from) * x);
    }
    case Part::kRest:
      return 0.0;
  }
  return 0.0;
}

// Every part is faded into from the one before, which goes on meanwhile: no jumps.
double Motion::Reference(double t) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    if (t >= part.end && i + 1 < parts_.size()) continue;
    const double s = (t - part.begin) / fade_s_;
    const double now = Of(part, t);
    if (s >= 1.0) return centre_ + now;
    const double before = i > 0 ? Of(parts_[i - 1], t) : 0.0;
    const double share = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    return centre_ + before + share * (now - before);
  }
  return centre_;
}

double Motion::Pressure(double t) const {
  if (pressures_.empty()) return 0.0;
  const double spell = duration_s_ / static_cast<double>(pressures_.size());
  if (locked_) return std::max(0.0, pressures_[0] * (1.0 - t / (0.9 * duration_s_)));
  const auto i = static_cast<std::size_t>(std::clamp(t / spell, 0.0, pressures_.size() - 1.0));
  return pressures_[i];
}

bool Motion::Valve(double t) const {
  if (locked_) return true;
  const double spell =
      duration_s_ / static_cast<double>(std::max<std::size_t>(1, pressures_.size()));
  return std::fmod(t, spell) < std::min(kPressureSpell_s, 0.4 * spell);
}

double Motion::Hand(double t) const {
  for (const Push& push : pushes_) {
    if (t >= push.begin && t < push.begin + push.length) {
      return 0.5 * push.force * (1.0 - std::cos(2.0 * kPi * (t - push.begin) / push.length));
    }
  }
  return 0.0;
}

double Motion::HandTarget(double t) const {
  double sum = 0.0;
  for (const Sine& sine : hand_) sum += sine.amplitude * std::sin(sine.omega * t + sine.phase);
  return sum;
}

}  // namespace sinew::rigs
