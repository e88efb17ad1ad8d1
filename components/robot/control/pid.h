// PID with filtered derivative and anti-windup by back-calculation, in discrete time.
//
//     P_k = Kp e_k
//     I_k = I_{k-1} + Ki e_k h
//     D_k = D_{k-1} + a (Kd r_k - D_{k-1}),   a = h / (h + 1 / (2 pi f))     (f = 0: D_k = Kd r_k)
//     u_k = P_k + I_k + D_k
//     after the caller limited u_k to s_k:  I_k += min(1, h / Tt) (s_k - u_k)
//
// e: position error; r: error of the velocity (derivative on the error) or minus the measured
// velocity (derivative on the measurement); the caller says which by what it passes. Source:
// Astrom, Hagglund: Advanced PID Control (2006), 3.5. Units: output side, Nm per rad; N per m for a
// prismatic joint. Thread: one. noexcept after construction, allocates nothing.
#pragma once

namespace sinew::types {
class StateArchive;
}

namespace sinew::control {

struct PidConfig {
  double proportional_Nm_rad = 0.0;
  double integral_Nm_rad_s = 0.0;  // Nm/(rad s): torque rate per error
  double derivative_Nm_s_rad = 0.0;
  double derivative_filter_Hz = 0.0;  // 0: none
  double anti_windup_s = 0.1;         // Tt
  double integral_limit_Nm = 0.0;     // bound of I; 0: none
};

class Pid {
 public:
  // Throws std::invalid_argument for gains that are negative or not finite, or anti_windup_s <= 0.
  explicit Pid(const PidConfig& config);

  // A new start: no integral, no derivative.
  void Reset() noexcept;
  // u_k, before any limit.
  double Step(double error_rad, double error_rate_rad_s, double period_s) noexcept;
  // The limited command was lower (or higher) by excess = s_k - u_k.
  void Limited(double excess_Nm, double period_s) noexcept;
  // The integral gets this much more: what another part of the command gives from now on, or no
  // longer, or what another controller's command had more.
  void Shift(double torque_Nm) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  double integral_Nm() const noexcept { return integral_Nm_; }
  double output_Nm() const noexcept { return output_Nm_; }

 private:
  PidConfig config_;
  double integral_Nm_ = 0.0;
  double derivative_Nm_ = 0.0;
  bool derivative_known_ = false;
  double output_Nm_ = 0.0;
};

}  // namespace sinew::control
