// Dry friction with true sticking: a bank of elastic elements that slip, with a breakaway torque
// that grows with the time at rest.
//
// Element i carries a spring of stiffness k_i, deflected by z_i, between the two bodies. While
// |k_i z_i| is below its yield torque w_i S it holds (no drift under a constant torque, however
// long); beyond it the element slides and keeps its yield torque (Maxwell-slip model: Iwan 1966;
// Al-Bender, Lampaert, Swevers, IEEE Trans. Automatic Control 50(11), 2005). The yield
// displacements are spread, so that torque bends over before gross sliding, as in measured
// presliding.
//
//     S = kinetic + growth * (1 - exp(-(a/tau)^1.5)),    da/dt = 1 - |v_slip| a / D
//
// a: age of the contacts. It grows one second per second of rest and is worn off over the slip
// distance D (Dieterich 1979, Ruina 1983; the saturating law replaces their logarithm, which has no
// end value).
//
// The bank only takes energy out: springs return at most what they took, dampers act while an
// element holds, sliding dissipates. Torque is returned as it acts on the moving body (against the
// motion). One owner; no allocation; Step is noexcept.
#pragma once

#include <array>

namespace sinew::surrogate {

struct SlipParameters {
  double kinetic_Nm = 0.22;            // while sliding; >= 0
  double rest_growth_Nm = 1.0;         // added after a long rest; >= 0
  double rest_time_s = 10.0;           // tau; > 0
  double renewal_distance_rad = 1e-3;  // D; > 0
  double presliding_rad = 3e-4;        // mean yield displacement at kinetic_Nm; > 0
  double presliding_damping_s = 3e-3;  // damper of an element = this times its stiffness; >= 0
};

class SlipBank {
 public:
  static constexpr int kElements = 5;

  explicit SlipBank(const SlipParameters& parameters);  // throws std::invalid_argument

  // Moves the body by velocity * dt against its ground. strength_scale multiplies the kinetic
  // torque (load on a mesh, a table over speed). Returns the friction torque on the body, N·m.
  double Step(double velocity_rad_s, double dt_s, double strength_scale = 1.0) noexcept;

  // As found after the given time at rest, all springs relaxed.
  void Reset(double rest_s) noexcept;

  double age_s() const noexcept { return age_s_; }
  double yield_Nm() const noexcept { return yield_Nm_; }  // S of the last step
  double spring_energy_J() const noexcept;
  double stiffness_Nm_rad() const noexcept { return stiffness_total_Nm_rad_; }

 private:
  SlipParameters parameters_;
  std::array<double, kElements> weight_{};
  std::array<double, kElements> stiffness_Nm_rad_{};
  std::array<double, kElements> deflection_rad_{};
  double stiffness_total_Nm_rad_ = 0.0;
  double age_s_ = 0.0;
  double yield_Nm_ = 0.0;
};

}  // namespace sinew::surrogate
