#include "components/robot/reference/trajectory.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"
#include "components/robot/reference/blend.h"

namespace sinew::reference {
namespace {

using types::kTwoPi;

void RequireFinite(double value, const char* what) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::string(what) + " is not finite");
  }
}

void RequirePositive(double value, const char* what) {
  if (!(value > 0.0)) {
    throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) +
                                ", expected more than 0");
  }
}

// One factor of a product of functions of time: value and two derivatives.
struct Jet {
  double value, rate, curvature;
};
Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.curvature * b.value + 2.0 * a.rate * b.rate + a.value * b.curvature};
}
Jet SineJet(double amplitude, double omega, double phase, double time) {
  const double angle = omega * time + phase;
  return {amplitude * std::sin(angle), amplitude * omega * std::cos(angle),
          -amplitude * omega * omega * std::sin(angle)};
}
Jet WeightJet(const BlendWeight& w) { return {w.value, w.rate_per_s, w.curvature_per_s2}; }

}  // namespace

Point Extrapolated(const Point& from, double time_s) noexcept {
  return {
      from.position_rad + time_s * (from.velocity_rad_s + 0.5 * time_s * from.acceleration_rad_s2),
      from.velocity_rad_s + time_s * from.acceleration_rad_s2, from.acceleration_rad_s2};
}

Hold::Hold(double position_rad, double duration_s)
    : position_rad_(position_rad), duration_s_(duration_s) {
  RequireFinite(position_rad, "position");
  RequirePositive(duration_s, "duration");
}

Point Hold::At(double /*time_s*/) const noexcept { return {position_rad_, 0.0, 0.0}; }

Sine::Sine(const SineConfig& config) : config_(config), omega_rad_s_(kTwoPi * config.frequency_Hz) {
  RequireFinite(config.center_rad, "center");
  RequireFinite(config.amplitude_rad, "amplitude");
  RequireFinite(config.phase_rad, "phase");
  RequireFinite(config.frequency_Hz, "frequency");
  RequirePositive(config.frequency_Hz, "frequency");
  RequirePositive(config.duration_s, "duration");
}

Point Sine::At(double time_s) const noexcept {
  const Jet jet = SineJet(config_.amplitude_rad, omega_rad_s_, config_.phase_rad, time_s);
  return {config_.center_rad + jet.value, jet.rate, jet.curvature};
}

Chirp::Chirp(const ChirpConfig& config) : config_(config) {
  RequireFinite(config.center_rad, "center");
  RequireFinite(config.amplitude_rad, "amplitude");
  RequireFinite(config.duration_s, "duration");
  RequirePositive(config.duration_s, "duration");
  RequireFinite(config.start_frequency_Hz, "start frequency");
  RequireFinite(config.end_frequency_Hz, "end frequency");
  RequireFinite(config.upper_frequency_Hz, "frequency of the upper amplitude");
  RequireFinite(config.lower_frequency_Hz, "frequency of the lower amplitude");
  RequireFinite(config.upper_phase_rad, "phase of the upper amplitude");
  RequireFinite(config.lower_phase_rad, "phase of the lower amplitude");
  const double peak = 0.5 * (std::abs(config.upper_amplitude) + std::abs(config.lower_amplitude));
  RequireFinite(peak, "amplitude bound");
  RequirePositive(peak, "sum of the amplitude bounds");
  scale_rad_ = config.amplitude_rad / peak;
}

Point Chirp::Unscaled(double time_s) const noexcept {
  const double sweep_Hz_s =
      (config_.end_frequency_Hz - config_.start_frequency_Hz) / config_.duration_s;
  const double phase =
      kTwoPi * (config_.start_frequency_Hz + 0.5 * sweep_Hz_s * time_s) * time_s;  // (5.7)
  const double omega = kTwoPi * (config_.start_frequency_Hz + sweep_Hz_s * time_s);
  const double omega_rate = kTwoPi * sweep_Hz_s;
  const Jet x{std::cos(phase), -omega * std::sin(phase),
              -omega_rate * std::sin(phase) - omega * omega * std::cos(phase)};
  const Jet upper = SineJet(config_.upper_amplitude, kTwoPi * config_.upper_frequency_Hz,
                            config_.upper_phase_rad, time_s);  // (5.8)
  const Jet lower = SineJet(config_.lower_amplitude, kTwoPi * config_.lower_frequency_Hz,
                            config_.lower_phase_rad, time_s);  // (5.9)
  const Jet half{0.5 * (upper.value - lower.value), 0.5 * (upper.rate - lower.rate),
                 0.5 * (upper.curvature - lower.curvature)};
  const Jet y = half * x;  // (5.10)
  return {y.value, y.rate, y.curvature};
}

Point Chirp::At(double time_s) const noexcept {
  const Point y = Unscaled(time_s);
  return {config_.center_rad + scale_rad_ * y.position_rad, scale_rad_ * y.velocity_rad_s,
          scale_rad_ * y.acceleration_rad_s2};
}

Step::Step(const StepConfig& config) : config_(config) {
  RequireFinite(config.from_rad, "start");
  RequireFinite(config.to_rad, "end");
  RequireFinite(config.step_at_s, "time of the step");
  RequireFinite(config.rise_s, "rise time");
  if (config.rise_s < 0.0) throw std::invalid_argument("rise time is negative");
  RequirePositive(config.duration_s, "duration");
}

Point Step::At(double time_s) const noexcept {
  const double since_s = time_s - config_.step_at_s;
  if (since_s < 0.0) return {config_.from_rad, 0.0, 0.0};
  return Mix({config_.from_rad, 0.0, 0.0}, {config_.to_rad, 0.0, 0.0},
             Blend(since_s, config_.rise_s));
}

Multisine::Multisine(const MultisineConfig& config) : config_(config) {
  RequireFinite(config.center_rad, "center");
  RequireFinite(config.amplitude_rad, "amplitude");
  RequireFinite(config.tilt, "tilt");
  RequireFinite(config.period_s, "period");
  RequirePositive(config.period_s, "period");
  RequirePositive(config.lowest_frequency_Hz, "lowest frequency");
  RequireFinite(config.highest_frequency_Hz, "highest frequency");
  RequirePositive(config.duration_s, "duration");
  const auto first =
      static_cast<long>(std::ceil(config.lowest_frequency_Hz * config.period_s - 1e-9));
  const auto last =
      static_cast<long>(std::floor(config.highest_frequency_Hz * config.period_s + 1e-9));
  if (last < first || last - first >= 1000) {
    throw std::invalid_argument("a multisine from " + std::to_string(config.lowest_frequency_Hz) +
                                " to " + std::to_string(config.highest_frequency_Hz) +
                                " Hz with period " + std::to_string(config.period_s) + " s has " +
                                std::to_string(std::max(0L, last - first + 1)) +
                                " lines, expected 1 to 1000");
  }
  std::mt19937_64 random(config.seed);
  for (long k = first; k <= last; ++k) {
    const double frequency_Hz = static_cast<double>(k) / config.period_s;
    const double phase_rad = kTwoPi * static_cast<double>(random() >> 11) * 0x1.0p-53;
    lines_.push_back({kTwoPi * frequency_Hz, std::pow(frequency_Hz, -config.tilt), phase_rad});
  }
  const auto grid = static_cast<long>(std::ceil(64.0 * static_cast<double>(last)));
  double peak = 0.0;
  for (long i = 0; i < grid; ++i) {
    const double time_s = config.period_s * static_cast<double>(i) / static_cast<double>(grid);
    peak = std::max(peak, std::abs(At(time_s).position_rad - config.center_rad));
  }
  for (Line& line : lines_) line.amplitude_rad *= config.amplitude_rad / peak;
}

Point Multisine::At(double time_s) const noexcept {
  Point point{config_.center_rad, 0.0, 0.0};
  for (const Line& line : lines_) {
    const Jet jet = SineJet(line.amplitude_rad, line.omega_rad_s, line.phase_rad, time_s);
    point.position_rad += jet.value;
    point.velocity_rad_s += jet.rate;
    point.acceleration_rad_s2 += jet.curvature;
  }
  return point;
}

// Speed rises as v S(u), S = 3u^2 - 2u^3, u = t / ramp: peak acceleration 1.5 v / ramp, way v ramp
// / 2.
Move::Move(const MoveConfig& config) : config_(config) {
  RequireFinite(config.from_rad, "start");
  RequireFinite(config.to_rad, "end");
  RequireFinite(config.speed_rad_s, "speed");
  RequirePositive(config.speed_rad_s, "speed");
  RequireFinite(config.acceleration_rad_s2, "acceleration");
  RequirePositive(config.acceleration_rad_s2, "acceleration");
  const double way = std::abs(config.to_rad - config.from_rad);
  sign_ = config.to_rad < config.from_rad ? -1.0 : 1.0;
  if (way == 0.0) return;
  speed_rad_s_ = std::min(config.speed_rad_s, std::sqrt(way * config.acceleration_rad_s2 / 1.5));
  ramp_s_ = 1.5 * speed_rad_s_ / config.acceleration_rad_s2;
  cruise_s_ = std::max(0.0, way / speed_rad_s_ - ramp_s_);
}

Point Move::At(double time_s) const noexcept {
  const double total_s = duration_s();
  if (!(time_s > 0.0)) return {config_.from_rad, 0.0, 0.0};
  if (!(time_s < total_s)) return {config_.to_rad, 0.0, 0.0};
  const auto rising = [this](double t) {
    const double u = t / ramp_s_;
    return Point{speed_rad_s_ * ramp_s_ * u * u * u * (1.0 - 0.5 * u),
                 speed_rad_s_ * u * u * (3.0 - 2.0 * u),
                 6.0 * speed_rad_s_ / ramp_s_ * u * (1.0 - u)};
  };
  if (time_s < ramp_s_) {
    const Point p = rising(time_s);
    return {config_.from_rad + sign_ * p.position_rad, sign_ * p.velocity_rad_s,
            sign_ * p.acceleration_rad_s2};
  }
  if (time_s < ramp_s_ + cruise_s_) {
    const double way = speed_rad_s_ * (0.5 * ramp_s_ + (time_s - ramp_s_));
    return {config_.from_rad + sign_ * way, sign_ * speed_rad_s_, 0.0};
  }
  const Point p = rising(total_s - time_s);
  return {config_.to_rad - sign_ * p.position_rad, sign_ * p.velocity_rad_s,
          -sign_ * p.acceleration_rad_s2};
}

Samples::Samples(std::vector<double> time_s, std::vector<double> position_rad)
    : time_s_(std::move(time_s)), position_rad_(std::move(position_rad)) {
  const std::size_t count = time_s_.size();
  if (count < 2 || position_rad_.size() != count) {
    throw std::invalid_argument("a sampled trajectory needs two or more samples, there are " +
                                std::to_string(count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(time_s_[i]) || !std::isfinite(position_rad_[i])) {
      throw std::invalid_argument("sample " + std::to_string(i) + " is not finite");
    }
    if (i > 0 && !(time_s_[i] > time_s_[i - 1])) {
      throw std::invalid_argument("time does not increase at sample " + std::to_string(i));
    }
  }
  const double origin_s = time_s_.front();
  for (double& t : time_s_) t -= origin_s;

  // Natural spline: tridiagonal equations for the second derivatives (Thomas algorithm).
  curvature_.assign(count, 0.0);
  std::vector<double> upper(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double h0 = time_s_[i] - time_s_[i - 1];
    const double h1 = time_s_[i + 1] - time_s_[i];
    const double right = 6.0 * ((position_rad_[i + 1] - position_rad_[i]) / h1 -
                                (position_rad_[i] - position_rad_[i - 1]) / h0);
    const double pivot = 2.0 * (h0 + h1) - h0 * upper[i - 1];
    upper[i] = h1 / pivot;
    curvature_[i] = (right - h0 * curvature_[i - 1]) / pivot;
  }
  for (std::size_t i = count - 2; i > 0; --i) curvature_[i] -= upper[i] * curvature_[i + 1];
}

Point Samples::At(double time_s) const noexcept {
  const std::size_t last = time_s_.size() - 1;
  const auto piece = [this](std::size_t i, double t) {
    const double h = time_s_[i + 1] - time_s_[i];
    const double m0 = curvature_[i];
    const double m1 = curvature_[i + 1];
    const double d = t - time_s_[i];
    const double slope = (position_rad_[i + 1] - position_rad_[i]) / h - h * (2.0 * m0 + m1) / 6.0;
    const double jerk = (m1 - m0) / h;
    return Point{position_rad_[i] + d * (slope + d * (0.5 * m0 + d * jerk / 6.0)),
                 slope + d * (m0 + 0.5 * d * jerk), m0 + d * jerk};
  };
  if (!(time_s > 0.0)) {
    const Point start = piece(0, 0.0);
    return {start.position_rad + start.velocity_rad_s * time_s, start.velocity_rad_s, 0.0};
  }
  if (!(time_s < time_s_[last])) {
    const Point end = piece(last - 1, time_s_[last]);
    return {end.position_rad + end.velocity_rad_s * (time_s - time_s_[last]), end.velocity_rad_s,
            0.0};
  }
  const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
  return piece(static_cast<std::size_t>(after - time_s_.begin()) - 1, time_s);
}

Windowed::Windowed(TrajectoryPtr inner, double center_rad, double duration_s, double fade_s)
    : inner_(std::move(inner)), center_rad_(center_rad), duration_s_(duration_s), fade_s_(fade_s) {
  RequireFinite(center_rad, "center");
  RequireFinite(duration_s, "duration");
  RequirePositive(duration_s, "duration");
  RequirePositive(fade_s, "fade");
  if (2.0 * fade_s > duration_s) {
    throw std::invalid_argument("fade of " + std::to_string(fade_s) +
                                " s at both ends does not fit in " + std::to_string(duration_s) +
                                " s");
  }
}

Point Windowed::At(double time_s) const noexcept {
  const Point x = inner_->At(time_s);
  const BlendWeight in = Blend(time_s, fade_s_);
  BlendWeight out = Blend(duration_s_ - time_s, fade_s_);
  out.rate_per_s = -out.rate_per_s;
  const Jet jet = WeightJet(in) * WeightJet(out) *
                  Jet{x.position_rad - center_rad_, x.velocity_rad_s, x.acceleration_rad_s2};
  return {center_rad_ + jet.value, jet.rate, jet.curvature};
}

Sequence::Sequence(std::vector<TrajectoryPtr> pieces) : pieces_(std::move(pieces)) {
  constexpr double kSame = 1e-9;
  if (pieces_.empty()) throw std::invalid_argument("a sequence needs at least one piece");
  start_s_.push_back(0.0);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const double duration = pieces_[i]->duration_s();
    if (i + 1 < pieces_.size() && !std::isfinite(duration)) {
      throw std::invalid_argument("piece " + std::to_string(i) + " of the sequence never ends");
    }
    if (i > 0) {
      const Point before = pieces_[i - 1]->At(pieces_[i - 1]->duration_s());
      const Point after = pieces_[i]->At(0.0);
      if (std::abs(before.position_rad - after.position_rad) > kSame ||
          std::abs(before.velocity_rad_s - after.velocity_rad_s) > kSame) {
        throw std::invalid_argument(
            "piece " + std::to_string(i) + " begins at " + std::to_string(after.position_rad) +
            " rad, the one before ends at " + std::to_string(before.position_rad) + " rad");
      }
    }
    start_s_.push_back(start_s_.back() + duration);
  }
}

Point Sequence::At(double time_s) const noexcept {
  std::size_t i = 0;
  while (i + 1 < pieces_.size() && time_s >= start_s_[i + 1]) ++i;
  return pieces_[i]->At(time_s - start_s_[i]);
}

Scaled::Scaled(TrajectoryPtr inner, double center_rad, double factor)
    : inner_(std::move(inner)), center_rad_(center_rad), factor_(factor) {
  RequireFinite(center_rad, "center");
  RequireFinite(factor, "factor");
}

Point Scaled::At(double time_s) const noexcept {
  const Point p = inner_->At(time_s);
  return {center_rad_ + factor_ * (p.position_rad - center_rad_), factor_ * p.velocity_rad_s,
          factor_ * p.acceleration_rad_s2};
}

}  // namespace sinew::reference
