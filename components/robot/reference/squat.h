// Squats of a robot with two legs: the base's height over time, and the joints that follow it.
//
// Heights are trajectories of the base in m, as those of a linear joint: 0 is the height with
// straight legs, down is negative, velocity and acceleration exact. No height comes nearer to 0
// than straight_margin_m, because a straight leg is singular: there a knee's velocity is unbounded.
//
// Squats. From the top to the bottom and back, cycles times:
//
//     z(t) = top - (depth - margin) / 2 (1 - cos(2 pi t / period)),  top = -margin
//
// Two cycles in 10 s are the benchmark; six make the run in which a weight is added.
// Before and after it stays at the top, at rest, so that a soft start at the top moves nothing: the
// acceleration begins with a step of (depth - margin) / 2 (2 pi / period)^2, 0.3 m/s^2 as shipped.
//
// Chirp. (5.6)-(5.10) of the source with y(t) of trajectory.h. (5.10) prints +-4 without a unit and
// no centre; the text asks for 0 to -400 mm, so the source's z is read as -200 + 50 y mm. Here
//
//     z(t) = -(depth + margin) / 2 + G(t) y(t) / y_peak,     A = (depth - margin) / 2
//     G(t) = A / sqrt(1 + (A w(t)^2 / a)^2),    w(t) = 2 pi (f0 + (f1 - f0) t / T)
//
// so G is about the smaller of A and a / w^2. Without that, A = 0.2 m would need more than 1 g
// above 1.1 Hz: downwards the feet would leave the ground. a is the largest for which |z''| keeps
// acceleration_m_s2, found on a grid of 5 ms.
//
// Constructors and functions throw std::invalid_argument with the value that is wrong. Set-up only,
// but for At. Thread: any.
#pragma once

#include <string>

#include "components/base/types/gravity.h"
#include "components/bodies/leg/squat.h"
#include "components/robot/reference/limits.h"
#include "components/robot/reference/trajectory.h"

namespace sinew::reference {

struct SquatsConfig {
  double straight_margin_m = 0.02;
  double depth_m = 0.4;  // of the lowest point below the straight legs
  int cycles = 2;
  double period_s = 5.0;
};
TrajectoryPtr MakeSquats(const SquatsConfig& config);

struct ChirpSquatConfig {
  double straight_margin_m = 0.02;
  double depth_m = 0.4;
  double acceleration_m_s2 = 0.8 * types::kGravity_m_s2;  // above 0, below 1 g
  ChirpConfig shape;                                      // center and amplitude are not used
};
class ChirpSquat final : public Trajectory {
 public:
  explicit ChirpSquat(const ChirpSquatConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return config_.shape.duration_s; }
  // G at the end of the chirp, m.
  double end_amplitude_m() const noexcept;

 private:
  Point Envelope(double time_s) const noexcept;  // G
  Point WithShape(double time_s, const Point& y) const noexcept;

  ChirpSquatConfig config_;
  Chirp shape_;
  double center_m_ = 0.0;
  double amplitude_m_ = 0.0;
  double shape_peak_ = 1.0;
  double knee_m_s2_ = 0.0;  // a
};

// The joints of a leg that move in a squat.
enum class SquatJoint { kHipPitch, kKnee, kAnklePitch };

// One of them, from the base's height by SquatAt of components/bodies/leg: sole flat, torso
// upright. Throws when the leg is straight, folded or does not reach anywhere on a grid of 1 ms.
// Before 0 and after the end, where the height may be out of reach, it rests at the pose of the
// start or of the end.
class SquatTrajectory final : public Trajectory {
 public:
  SquatTrajectory(TrajectoryPtr base_height, const leg::LegGeometry& geometry,
                  double foot_forward_m, SquatJoint joint);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return height_->duration_s(); }

 private:
  TrajectoryPtr height_;
  leg::LegGeometry geometry_;
  double foot_forward_m_;
  double straight_m_;
  SquatJoint joint_;
};

// "joint 'left_knee': velocity reaches 12.3 rad/s, limit 10 rad/s", or nothing. On a grid of 1 ms.
std::string FirstPassedLimit(const std::string& joint_name, const Trajectory& trajectory,
                             const Limits& limits);

}  // namespace sinew::reference
