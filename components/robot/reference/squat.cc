#include "components/robot/reference/squat.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "components/base/types/angle.h"

namespace sinew::reference {

namespace {

void CheckDepth(double margin_m, double depth_m) {
  if (margin_m > 0.0 && depth_m > margin_m && std::isfinite(depth_m)) return;
  std::ostringstream message;
  message << "depth " << depth_m << " m and margin to the straight leg " << margin_m
          << " m, expected 0 < margin < depth";
  throw std::invalid_argument(message.str());
}

Point PointOf(const leg::JointMotion& joint) noexcept {
  return {joint.position_rad, joint.velocity_rad_s, joint.acceleration_rad_s2};
}

Point PointOf(const leg::SquatMotion& motion, SquatJoint joint) noexcept {
  if (joint == SquatJoint::kHipPitch) return PointOf(motion.hip_pitch);
  return PointOf(joint == SquatJoint::kKnee ? motion.knee : motion.ankle_pitch);
}

// Whole cycles from the top, at rest before and after.
class Squats final : public Trajectory {
 public:
  explicit Squats(const SineConfig& sine) : sine_(sine) {}
  Point At(double time_s) const noexcept override {
    if (time_s >= 0.0 && time_s <= duration_s()) return sine_.At(time_s);
    return {sine_.At(0.0).position_rad, 0.0, 0.0};
  }
  double duration_s() const noexcept override { return sine_.duration_s(); }

 private:
  Sine sine_;
};

}  // namespace

TrajectoryPtr MakeSquats(const SquatsConfig& config) {
  CheckDepth(config.straight_margin_m, config.depth_m);
  if (config.cycles < 1 || !(config.period_s > 0.0) || !std::isfinite(config.period_s)) {
    std::ostringstream message;
    message << config.cycles << " squats of " << config.period_s << " s, expected both above 0";
    throw std::invalid_argument(message.str());
  }
  SineConfig sine;
  sine.center_rad = -0.5 * (config.depth_m + config.straight_margin_m);
  sine.amplitude_rad = 0.5 * (config.depth_m - config.straight_margin_m);
  sine.frequency_Hz = 1.0 / config.period_s;
  sine.phase_rad = 0.5 * std::numbers::pi;
  sine.duration_s = config.cycles * config.period_s;
  const double peak_m_s2 = sine.amplitude_rad * std::pow(types::kTwoPi * sine.frequency_Hz, 2);
  if (!(peak_m_s2 < types::kGravity_m_s2)) {
    std::ostringstream message;
    message << "the base's acceleration reaches " << peak_m_s2 << " m/s2, expected less than 1 g";
    throw std::invalid_argument(message.str());
  }
  return std::make_shared<Squats>(sine);
}

ChirpSquat::ChirpSquat(const ChirpSquatConfig& config)
    : config_(config),
      shape_(config.shape),
      center_m_(-0.5 * (config.depth_m + config.straight_margin_m)),
      amplitude_m_(0.5 * (config.depth_m - config.straight_margin_m)),
      shape_peak_(
          0.5 * (std::abs(config.shape.upper_amplitude) + std::abs(config.shape.lower_amplitude))) {
  CheckDepth(config.straight_margin_m, config.depth_m);
  if (!(config.acceleration_m_s2 > 0.0) || !(config.acceleration_m_s2 < types::kGravity_m_s2)) {
    throw std::invalid_argument("acceleration " + std::to_string(config.acceleration_m_s2) +
                                " m/s2, expected above 0 and below 1 g");
  }
  constexpr double kGrid_s = 5e-3;
  const auto count = static_cast<std::size_t>(std::ceil(duration_s() / kGrid_s));
  std::vector<Point> shape(count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    shape[i] = shape_.Unscaled(static_cast<double>(i) * kGrid_s);
  }
  const auto keeps_limit = [&] {
    for (std::size_t i = 0; i <= count; ++i) {
      const Point z = WithShape(static_cast<double>(i) * kGrid_s, shape[i]);
      if (!(std::abs(z.acceleration_rad_s2) <= config_.acceleration_m_s2)) return false;
    }
    return true;
  };
  // |z''| grows with a: bisection between nothing and far above the limit.
  double lower = 0.0, upper = 10.0 * config.acceleration_m_s2;
  constexpr int kHalvings = 24;
  for (int i = 0; i < kHalvings; ++i) {
    knee_m_s2_ = 0.5 * (lower + upper);
    (keeps_limit() ? lower : upper) = knee_m_s2_;
  }
  knee_m_s2_ = lower;
  if (!(lower > 0.0)) {
    throw std::invalid_argument("no amplitude keeps the acceleration " +
                                std::to_string(config.acceleration_m_s2) + " m/s2");
  }
}

Point ChirpSquat::Envelope(double time_s) const noexcept {
  const ChirpConfig& c = config_.shape;
  const double dw = types::kTwoPi * (c.end_frequency_Hz - c.start_frequency_Hz) / c.duration_s;
  const double w = types::kTwoPi * c.start_frequency_Hz + dw * time_s;
  const double scale = amplitude_m_ / knee_m_s2_;
  const double r = scale * w * w, dr = 2.0 * scale * w * dw, ddr = 2.0 * scale * dw * dw;
  const double q = 1.0 + r * r, dq = 2.0 * r * dr, ddq = 2.0 * (dr * dr + r * ddr);
  const double root = 1.0 / std::sqrt(q);
  return {amplitude_m_ * root, -0.5 * amplitude_m_ * root / q * dq,
          amplitude_m_ * root / q * (0.75 * dq * dq / q - 0.5 * ddq)};
}

Point ChirpSquat::At(double time_s) const noexcept {
  return WithShape(time_s, shape_.Unscaled(time_s));
}

Point ChirpSquat::WithShape(double time_s, const Point& y) const noexcept {
  const Point g = Envelope(time_s);
  return {center_m_ + g.position_rad * y.position_rad / shape_peak_,
          (g.velocity_rad_s * y.position_rad + g.position_rad * y.velocity_rad_s) / shape_peak_,
          (g.acceleration_rad_s2 * y.position_rad + 2.0 * g.velocity_rad_s * y.velocity_rad_s +
           g.position_rad * y.acceleration_rad_s2) /
              shape_peak_};
}

double ChirpSquat::end_amplitude_m() const noexcept {
  return Envelope(config_.shape.duration_s).position_rad;
}

SquatTrajectory::SquatTrajectory(TrajectoryPtr base_height, const leg::LegGeometry& geometry,
                                 double foot_forward_m, SquatJoint joint)
    : height_(std::move(base_height)),
      geometry_(geometry),
      foot_forward_m_(foot_forward_m),
      straight_m_(leg::StraightHeight(geometry, foot_forward_m)),
      joint_(joint) {
  if (!height_) throw std::invalid_argument("no base height");
  if (!std::isfinite(height_->duration_s())) {
    throw std::invalid_argument("the base's height never ends");
  }
  const Extremes base = Measure(*height_, 0.0);
  for (const double z : {base.position_lower_rad, base.position_upper_rad}) {
    if (leg::SquatAt(geometry_, foot_forward_m_, {straight_m_ + z, 0.0, 0.0})) continue;
    std::ostringstream message;
    message << "the leg does not reach the base height " << z << " m below its straight height of "
            << straight_m_ << " m between hip and ankle";
    throw std::invalid_argument(message.str());
  }
}

Point SquatTrajectory::At(double time_s) const noexcept {
  const Point z = height_->At(time_s);
  const auto motion =
      leg::SquatAt(geometry_, foot_forward_m_,
                   {straight_m_ + z.position_rad, z.velocity_rad_s, z.acceleration_rad_s2});
  if (motion) return PointOf(*motion, joint_);
  const Point end = height_->At(time_s < 0.0 ? 0.0 : height_->duration_s());
  const auto rest =
      leg::SquatAt(geometry_, foot_forward_m_, {straight_m_ + end.position_rad, 0.0, 0.0});
  return rest ? PointOf(*rest, joint_) : Point{};
}

std::string FirstPassedLimit(const std::string& joint_name, const Trajectory& trajectory,
                             const Limits& limits) {
  const Extremes e = Measure(trajectory, 1.0);
  std::ostringstream message;
  const auto passed = [&](const char* what, double value, double limit, const char* unit) {
    message << "joint '" << joint_name << "': " << what << " reaches " << value << " " << unit
            << ", limit " << limit << " " << unit;
    return message.str();
  };
  if (!(e.position_lower_rad >= limits.position_lower_rad)) {
    return passed("position", e.position_lower_rad, limits.position_lower_rad, "rad");
  }
  if (!(e.position_upper_rad <= limits.position_upper_rad)) {
    return passed("position", e.position_upper_rad, limits.position_upper_rad, "rad");
  }
  if (!(e.velocity_rad_s <= limits.velocity_rad_s)) {
    return passed("velocity", e.velocity_rad_s, limits.velocity_rad_s, "rad/s");
  }
  if (!(e.acceleration_rad_s2 <= limits.acceleration_rad_s2)) {
    return passed("acceleration", e.acceleration_rad_s2, limits.acceleration_rad_s2, "rad/s2");
  }
  return "";
}

}  // namespace sinew::reference
