#include "components/learn/rls/adapter.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "components/base/types/require.h"

namespace sinew::rls {

Adapter::Adapter(const AdapterConfig& config, const std::optional<Eigen::MatrixXd>& sea_readout,
                 const std::optional<Eigen::MatrixXd>& pea_readout)
    : config_(config) {
  if (!sea_readout && !pea_readout) {
    throw std::invalid_argument("readouts: none, expected that of a SEA or a PEA network");
  }
  types::Require(config.slowest_velocity_rad_s >= 0.0, "slowest_velocity_rad_s",
                 config.slowest_velocity_rad_s, "at least 0");
  types::Require(config.still_after_s >= 0.0, "still_after_s", config.still_after_s, "at least 0");
  if (sea_readout) slots_[0].emplace(Slot{RecursiveLeastSquares(config.rls, *sea_readout)});
  if (pea_readout) slots_[1].emplace(Slot{RecursiveLeastSquares(config.rls, *pea_readout)});
  Reset();
}

void Adapter::Reset() noexcept {
  for (std::optional<Slot>& slot : slots_) {
    if (!slot) continue;
    slot->estimator.Reset();
    slot->version = 0;
  }
  network_ = slots_[1] ? 1 : 0;
  updates_ = 0;
  still_s_ = std::numeric_limits<double>::infinity();
}

bool Adapter::Adopt(int network, std::uint64_t version,
                    const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept {
  if (network < 0 || network > 1 || !has(network)) return false;
  Slot& slot = *slots_[static_cast<std::size_t>(network)];
  if (!slot.estimator.SetReadout(readout)) return false;
  slot.version = version;
  updates_ = std::max(updates_, version);
  return true;
}

Frozen Adapter::Step(const Observation& o) noexcept {
  if (o.fastest_velocity_rad_s >= config_.slowest_velocity_rad_s) {
    still_s_ = 0.0;
  } else {
    still_s_ += o.period_s;  // also where the velocity is not a number
  }
  if (!o.armed) return Frozen::kNotArmed;
  if (!o.usable || o.network < 0 || o.network > 1 || !has(o.network)) return Frozen::kNoSample;
  network_ = o.network;
  if (still_s_ > config_.still_after_s) return Frozen::kStandingStill;
  Slot& slot = *slots_[static_cast<std::size_t>(o.network)];
  if (slot.estimator.Update(o.features, o.target_Nm) == UpdateStatus::kBadInput)
    return Frozen::kNoSample;
  slot.version = ++updates_;
  return Frozen::kNo;
}

}  // namespace sinew::rls
