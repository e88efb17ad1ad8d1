// Delay between the recorded drive input and its torque: T > 0 when the drive acts late, T < 0 when
// it is recorded late.
//
// What is missing is K (I(t - T) - I(t)) = -T K times the mean of dI/dt over the last T. To first
// order that is dI/dt itself; where the drive reverses within T (dry friction) it is not. The delay
// is four equal lags in a row, (1 + s T / 4)^-4 (Erlang; its error against exp(-s T) is of second
// order), for which the mean rate is that of the four lagged rates: with L the lag of T / 4,
// 1 - L^4 = (s T / 4) (L + L^2 + L^3 + L^4).
//
// Memory: the rate after one to four lags.
#include "components/model/effects/define.h"

namespace sinew::effects::transport_delay {

namespace {

constexpr int kLags = 4;

class TransportDelay final : public Effect {
 public:
  TransportDelay(EffectInfo info, const JointConstants& constants)
      : Effect(std::move(info)), gain_(IdealDriveGain(constants)) {}

  void Regressors(const JointSample& x, std::span<const double> /*psi*/,
                  std::span<const double> memory, std::span<double> phi) const noexcept override {
    double sum = 0.0 * x.drive_rate;
    for (const double rate : memory) sum += rate;
    phi[0] = -gain_ * sum / kLags;
  }

  int memory_size() const noexcept override { return kLags; }

  void ResetMemory(const JointSample& x, std::span<const double> /*psi*/,
                   std::span<double> memory) const noexcept override {
    for (double& rate : memory) rate = x.drive_rate;
  }

  void Advance(const JointSample& x, double dt_s, std::span<const double> psi,
               std::span<double> memory) const noexcept override {
    const double lag_s = std::abs(psi[0]) / kLags;
    const double fade = lag_s > 0.0 ? std::exp(-dt_s / lag_s) : 0.0;
    double rate = x.drive_rate;
    for (double& lagged : memory) {
      lagged = rate + fade * (lagged - rate);
      rate = lagged;
    }
  }

 private:
  double gain_;
};

}  // namespace

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Drive that acts late";
  info.formula = "- T * N Kt <dI/dt>, the mean over the last `span`";
  info.source = "I(t - T) - I(t), four equal lags in a row (Erlang)";
  info.side = Side::kMotor;
  info.smallest = Smallest::kTenthOfSample;
  info.follows_record = true;
  info.linear = {RelativeToDrive(
      Linear("delay", Dimension::kTime, {-0.1, 0.1},
             "the drive acts this much later than recorded; negative: it is recorded late"))};
  info.nonlinear = {Nonlinear("span", Dimension::kTime, {-0.1, 0.1}, 0.0, {0.0},
                              "over which the drive's rate counts: the delay itself, 0 where "
                              "it is shorter than the drive's own changes")};
  info.nonlinear.front().optional = true;
  info.signature = "residual follows the rate of the drive input";
  info.confounders = {"elastic_joint", "flexible_link", "gear_compliance"};
  info.separating_excitation =
      "fast reversals; the delay stays when the load changes, flexibility does not";
  info.needs = {"drive_rate"};
  return std::make_unique<TransportDelay>(std::move(info), constants);
}

}  // namespace sinew::effects::transport_delay
