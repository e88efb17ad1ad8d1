// Air in vessels, orifices between them, and the relays that open them.
//
// Vessel: ideal gas with mass m and internal energy U in a volume V.
//
//     dm/dt = sum of mass flows
//     dU/dt = sum of cp T_upstream * flow - p dV/dt + G (T_wall - T)
//     p = (cp/cv - 1) U / V,   T = U / (m cv)
//
// The work of a volume change is done exactly as an adiabatic step, U V^(kappa-1) = constant, so
// that the adiabatic limit (G = 0) holds to rounding for any step; large G gives the isothermal
// limit.
//
// Orifice (ISO 6358-1): flow = C rho0 p1 sqrt(T0/T1) * psi(p2/p1), psi = 1 up to the critical ratio
// b (choked), else sqrt(1 - ((r - b)/(1 - b))^2); above r = 0.995 psi is linear to 0 (laminar),
// which keeps the slope finite. C in m3/(s Pa) at the reference air (1 bar, 293.15 K).
//
// Pressures are absolute, Pa, inside this file. One owner; no allocation; steps are noexcept.
#pragma once

namespace sinew::surrogate {

struct Air {
  static constexpr double kGasConstant_J_kgK = 287.05;
  static constexpr double kCv_J_kgK = 717.6;
  static constexpr double kCp_J_kgK = kCv_J_kgK + kGasConstant_J_kgK;
  static constexpr double kReferenceTemperature_K = 293.15;
  static constexpr double kReferenceDensity_kg_m3 = 1.1884;
};

class Vessel {
 public:
  Vessel(double volume_m3, double pressure_Pa, double temperature_K, double wall_conductance_W_K);
  void Reset(double volume_m3, double pressure_Pa, double temperature_K) noexcept;

  // Changes the volume without heat or flow.
  void SetVolume(double volume_m3) noexcept;
  // Air coming in (upstream temperature given) or, negative, going out (at its own temperature),
  // kg.
  void AddMass(double mass_kg, double upstream_temperature_K) noexcept;
  // resistance_K_W: between gas and wall, on top of the wall's own.
  void ExchangeHeat(double wall_temperature_K, double dt_s, double resistance_K_W = 0.0) noexcept;

  double pressure_Pa() const noexcept { return pressure_Pa_; }
  double temperature_K() const noexcept { return temperature_K_; }
  double mass_kg() const noexcept { return mass_kg_; }
  double energy_J() const noexcept { return energy_J_; }
  double volume_m3() const noexcept { return volume_m3_; }

 private:
  void Update() noexcept;

  double volume_m3_;
  double mass_kg_ = 0.0;
  double energy_J_ = 0.0;
  double pressure_Pa_ = 0.0;
  double temperature_K_ = 0.0;
  double wall_conductance_W_K_;
};

struct Orifice {
  double conductance_m3_sPa = 0.0;  // C
  double critical_ratio = 0.3;      // b
};

// Mass flow from side 1 to side 2, kg/s; negative when it runs the other way.
double MassFlow_kg_s(const Orifice& orifice, double pressure_1_Pa, double temperature_1_K,
                     double pressure_2_Pa, double temperature_2_K) noexcept;

struct RelayParameters {
  double on_delay_s = 0.0;
  double off_delay_s = 0.0;
  double travel_s = 0.0;  // from shut to open, linear
};

// A switch that acts after a dead time and then travels. Commands shorter than the dead time are
// lost.
class Relay {
 public:
  explicit Relay(const RelayParameters& parameters);  // throws std::invalid_argument
  void Reset(bool on) noexcept;
  // Returns the opening, 0 to 1. late_s: on top of both delays.
  double Step(bool command, double dt_s, double late_s = 0.0) noexcept;
  double opening() const noexcept { return opening_; }

 private:
  RelayParameters parameters_;
  bool on_ = false;
  double waited_s_ = 0.0;
  double opening_ = 0.0;
};

}  // namespace sinew::surrogate
