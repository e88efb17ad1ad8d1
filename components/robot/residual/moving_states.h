// The states that a joint model reads, live: a polynomial of degree 4 through the last 2 h + 1
// samples of every channel (least squares; Savitzky, Golay: Anal. Chem. 36 (1964) 1627), and its
// value and derivatives in the middle of that window. Drive and motion go through one and the same
// window, so that its distortion is on both sides of the balance (Gautier 1997, as in identify).
//
// The states are those of h samples ago: the price of derivatives without phase. Thread: one.
// Nothing but the constructor allocates.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "components/model/effects/sample.h"

namespace sinew::residual {

// The sensor values of a joint at one tick. SI, signs as in idl/.
struct JointReading {
  bool valid = false;
  double position_rad = 0.0;        // output
  double motor_position_rad = 0.0;  // shaft
  double drive_input = 0.0;         // A, or V
  double pressure_bar = 0.0;
  double load_force_N = 0.0;
  double payload_kg = 0.0;
  double temperature_degC = 25.0;
  bool valve_open = false;
};

class MovingStates {
 public:
  // window_s: its whole width, at least 9 samples (2 h + 1 of them, h rounded). Throws
  // std::invalid_argument for a period or window that is not positive or takes more than 2001.
  MovingStates(double period_s, double window_s);

  void Reset() noexcept;
  // False: the window is not full, or a sample in it was lost or not a number; the state is not
  // touched.
  bool Push(const JointReading& reading, double time_s, effects::JointSample* state) noexcept;

  int half_window() const noexcept { return half_; }
  double delay_s() const noexcept { return half_ * period_s_; }

 private:
  enum Channel { kOutput, kMotor, kDrive, kPressure, kChannels };

  double Derivative(Channel channel, int order) const noexcept;

  double period_s_;
  int half_;
  Eigen::Matrix<double, 5, Eigen::Dynamic> weights_;  // a row per derivative
  // Every sample twice, width apart, so that a window is always in one piece.
  std::array<std::vector<double>, kChannels> ring_;
  std::vector<JointReading> readings_;
  int next_ = 0;
  int good_ = 0;  // usable samples in a row
};

}  // namespace sinew::residual
