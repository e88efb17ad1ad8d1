// Gas that is not at the wall's temperature: between isothermal and adiabatic.
//
// e = (T - T_wall) / T_wall, small. Shut, compression heats and the wall cools; open, gas that
// comes in is compressed by what follows (and cools what goes out):
//
//     shut:  de/dt = -(k - 1) dV/dt / V - e / tau
//     open:  k de/dt = (k - 1) d ln(P + Pa)/dt - e / tau
//
// and the pressure is (P + Pa) (1 + e) of the isothermal one. Two states, because what compression
// and what filling leave behind need not mix to the same degree.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::gas_heat_exchange {

namespace {

constexpr double kKappa = 1.4;

class HeatExchange final : public Effect {
 public:
  HeatExchange(EffectInfo info, const JointConstants& constants)
      : Effect(std::move(info)), constants_(constants) {}
  int memory_size() const noexcept override { return 2; }

  void ResetMemory(const JointSample&, std::span<const double>,
                   std::span<double> memory) const noexcept override {
    memory[0] = memory[1] = 0.0;
  }

  void Advance(const JointSample& x, double dt_s, std::span<const double> psi,
               std::span<double> memory) const noexcept override {
    const double decay = std::exp(-dt_s / psi[0] / (x.valve_open ? kKappa : 1.0));
    // Constant drive over the step, the relaxation exact.
    const double gain = psi[0] * (x.valve_open ? kKappa : 1.0) * (1.0 - decay);
    const double squeezed = -(kKappa - 1.0) * x.volume_rate_1_s;
    const double filled = (kKappa - 1.0) / kKappa * x.pressure_rate_bar_s /
                          (x.pressure_bar + constants_.atmosphere_bar);
    memory[0] = decay * memory[0] + (x.valve_open ? 0.0 : gain * squeezed);
    memory[1] = decay * memory[1] + (x.valve_open ? gain * filled : 0.0);
  }

  void Regressors(const JointSample& x, std::span<const double> psi, std::span<const double> memory,
                  std::span<double> phi) const noexcept override {
    const double pressure = x.pressure_bar + constants_.atmosphere_bar;
    const double shut = x.valve_open ? 0.0 : 1.0;
    // A value that is not finite shows, though the valve hides what it drives.
    const double bad = 0.0 * (x.pressure_rate_bar_s + x.volume_rate_1_s);
    phi[0] = -shut * pressure * (-(kKappa - 1.0) * x.volume_rate_1_s - memory[0] / psi[0]) + bad;
    phi[1] = shut * pressure * memory[1] / psi[0] + bad;
  }

 private:
  JointConstants constants_;
};

}  // namespace

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Gas that exchanges heat with the wall";
  info.formula = "- integral of (P + Pa) de/dt, de/dt = -(k - 1) dV/dt / V - e / tau";
  info.source =
      "Pourmovahed, Otis: An experimental thermal time-constant correlation for hydraulic "
      "accumulators (1990), eq. 3";
  info.rate = true;
  info.linear = {Linear("compression_share", Dimension::kNone, {-0.2, 2.0},
                        "1: all of the gas is heated by compression; 0: none"),
                 Linear("filling_share", Dimension::kNone, {-0.2, 2.0},
                        "1: all of the gas is heated by being filled; 0: none")};
  info.nonlinear = {Nonlinear("time_constant", Dimension::kTime, {0.02, 60.0}, 1.0,
                              {0.1, 0.2, 0.5, 1.0, 2.0, 5.0},
                              "of the gas toward the wall's temperature")};
  info.signature =
      "pressure answers fast compression more than slow, and relaxes after the valve shut";
  info.variable = "volume_rate_1_s";
  info.confounders = {"leak", "gas_compression"};
  info.separating_excitation =
      "the same stroke fast and slow with the valve shut; rest after filling";
  info.needs = {"pressure_bar", "pressure_rate_bar_s", "volume_rate_1_s"};
  return std::make_unique<HeatExchange>(std::move(info), constants);
}

}  // namespace sinew::effects::gas::gas_heat_exchange
