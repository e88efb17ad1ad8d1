// Trajectories of one joint: position, velocity and acceleration as functions of time, consistent
// with each other (velocity and acceleration are the exact derivatives of position).
//
// SI; a prismatic joint reads m for rad (docs/decisions/0003). Time 0 is the start of the
// trajectory; At may be asked for any time, before the start too, so that a soft start can run into
// a moving trajectory. Constructors throw std::invalid_argument with the value that is wrong. At
// allocates nothing and may be called from any thread.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace sinew::types {
class StateArchive;
}

namespace sinew::reference {

struct Point {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double acceleration_rad_s2 = 0.0;

  void Exchange(types::StateArchive& archive);  // types/state_archive.h
};

// The point a time later, at its acceleration.
Point Extrapolated(const Point& from, double time_s) noexcept;

inline constexpr double kEndless = std::numeric_limits<double>::infinity();

class Trajectory {
 public:
  virtual ~Trajectory() = default;
  virtual Point At(double time_s) const noexcept = 0;
  virtual double duration_s() const noexcept = 0;  // kEndless: it never ends
};

using TrajectoryPtr = std::shared_ptr<const Trajectory>;

// Rest at a position.
class Hold final : public Trajectory {
 public:
  explicit Hold(double position_rad, double duration_s = kEndless);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return duration_s_; }

 private:
  double position_rad_;
  double duration_s_;
};

// position = center + amplitude sin(2 pi f t + phase)
struct SineConfig {
  double center_rad = 0.0;
  double amplitude_rad = 0.0;
  double frequency_Hz = 0.0;
  double phase_rad = 0.0;
  double duration_s = kEndless;
};
class Sine final : public Trajectory {
 public:
  explicit Sine(const SineConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return config_.duration_s; }

 private:
  SineConfig config_;
  double omega_rad_s_;
};

// The published chirp with a breathing amplitude, (5.6)-(5.10):
//
//     x(t)     = cos(2 pi (f0 t + (f1 - f0) / (2 T) t^2))                       (5.7)
//     A_max(t) = A_amp,max sin(2 pi f_amp,max t + phi_max)                      (5.8)
//     A_min(t) = A_amp,min sin(2 pi f_amp,min t + phi_min)                      (5.9)
//     y(t)     = (A_max(t) - A_min(t)) / 2 * x(t)                               (5.10)
//     position = center + amplitude * y(t) / ((A_amp,max + A_amp,min) / 2)
//
// y has no unit and reaches +-4 with the published figures, which are the defaults here;
// amplitude_rad is the joint's excursion at that peak. The instantaneous frequency of x goes from
// f0 to f1 over T.
struct ChirpConfig {
  double center_rad = 0.0;
  double amplitude_rad = 0.0;
  double duration_s = 200.0;                     // T
  double start_frequency_Hz = 0.15;              // f0
  double end_frequency_Hz = 1.5;                 // f1
  double upper_amplitude = 8.0;                  // A_amp,max
  double lower_amplitude = 0.0;                  // A_amp,min
  double upper_frequency_Hz = 0.13;              // f_amp,max
  double lower_frequency_Hz = 0.07;              // f_amp,min
  double upper_phase_rad = 1.5707963267948966;   // phi_max = pi/2
  double lower_phase_rad = 0.78539816339744831;  // phi_min = pi/4
};
class Chirp final : public Trajectory {
 public:
  explicit Chirp(const ChirpConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return config_.duration_s; }
  // y(t) of (5.10) with its derivatives, without unit.
  Point Unscaled(double time_s) const noexcept;

 private:
  ChirpConfig config_;
  double scale_rad_;
};

// From one position to another at step_at_s, in rise_s (quintic; 0: a jump, derivatives 0).
struct StepConfig {
  double from_rad = 0.0;
  double to_rad = 0.0;
  double step_at_s = 0.0;
  double rise_s = 0.0;
  double duration_s = kEndless;
};
class Step final : public Trajectory {
 public:
  explicit Step(const StepConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return config_.duration_s; }

 private:
  StepConfig config_;
};

// Sum of sines at multiples of 1 / period_s between two frequencies, phases drawn from the seed,
// line k with an amplitude proportional to f_k^-tilt (tilt 1: equal velocity amplitudes), scaled so
// that the largest excursion over a period is amplitude_rad.
struct MultisineConfig {
  double center_rad = 0.0;
  double amplitude_rad = 0.0;
  double lowest_frequency_Hz = 0.1;
  double highest_frequency_Hz = 2.0;
  double period_s = 20.0;
  double tilt = 1.0;
  std::uint64_t seed = 1;
  double duration_s = kEndless;
};
class Multisine final : public Trajectory {
 public:
  explicit Multisine(const MultisineConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return config_.duration_s; }
  int line_count() const noexcept { return static_cast<int>(lines_.size()); }

 private:
  struct Line {
    double omega_rad_s;
    double amplitude_rad;
    double phase_rad;
  };
  MultisineConfig config_;
  std::vector<Line> lines_;
};

// From rest to rest at constant speed; speed is reached and left with a smooth step whose largest
// acceleration is acceleration_rad_s2. Short ways never reach the speed.
struct MoveConfig {
  double from_rad = 0.0;
  double to_rad = 0.0;
  double speed_rad_s = 0.1;
  double acceleration_rad_s2 = 1.0;
};
class Move final : public Trajectory {
 public:
  explicit Move(const MoveConfig& config);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return 2.0 * ramp_s_ + cruise_s_; }
  // Exchanges the configuration and what was computed from it, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  MoveConfig config_;
  double sign_ = 1.0;
  double speed_rad_s_ = 0.0;  // reached
  double ramp_s_ = 0.0;
  double cruise_s_ = 0.0;
};

// Samples joined by a natural cubic spline: position through every sample, velocity and
// acceleration continuous. Outside the samples it goes on in a straight line.
class Samples final : public Trajectory {
 public:
  // At least two samples, times strictly increasing; the first time becomes 0.
  Samples(std::vector<double> time_s, std::vector<double> position_rad);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return time_s_.back(); }

 private:
  std::vector<double> time_s_;
  std::vector<double> position_rad_;
  std::vector<double> curvature_;  // second derivative at the samples
};

// An endless or long trajectory cut to a piece that starts and ends at rest at its center:
// center + w(t) w(D - t) (inner(t) - center), w the quintic of blend.h over fade_s.
class Windowed final : public Trajectory {
 public:
  Windowed(TrajectoryPtr inner, double center_rad, double duration_s, double fade_s);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return duration_s_; }

 private:
  TrajectoryPtr inner_;
  double center_rad_;
  double duration_s_;
  double fade_s_;
};

// One after the other. Every piece but the last must end. Throws when a piece does not begin where
// the one before ended (position within 1e-9 rad, both at rest).
class Sequence final : public Trajectory {
 public:
  explicit Sequence(std::vector<TrajectoryPtr> pieces);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return start_s_.back(); }

 private:
  std::vector<TrajectoryPtr> pieces_;
  std::vector<double> start_s_;  // of each piece, and the end
};

// center + factor (inner - center).
class Scaled final : public Trajectory {
 public:
  Scaled(TrajectoryPtr inner, double center_rad, double factor);
  Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return inner_->duration_s(); }

 private:
  TrajectoryPtr inner_;
  double center_rad_;
  double factor_;
};

}  // namespace sinew::reference
