// Adaptation of the readouts: when to learn, and for which network; target.h says from what.
//
// Nothing is learnt (frozen) while
//  - the robot is not armed, or the sample is not usable: no network counted, the command was not a
//    torque command or a safe one, something was lost or late;
//  - the joints stand still for longer than still_after_s: at rest the sign of friction is unknown.
//
// A readout's version is the number of updates of all networks when it last changed; 0 is the
// offline readout.
//
// One thread. No memory is taken in Step.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "components/learn/rls/rls.h"

namespace sinew::rls {

struct AdapterConfig {
  Config rls;
  double slowest_velocity_rad_s = 0.02;  // slower counts as standing still; the fastest joint; >= 0
  double still_after_s = 0.25;           // >= 0
};

enum class Frozen { kNo, kNotArmed, kStandingStill, kNoSample };

// One tick. network: 0 SEA, 1 PEA, as in the topics.
struct Observation {
  bool armed = false;
  bool usable = false;
  double fastest_velocity_rad_s = 0.0;  // largest absolute value over the joints
  double period_s = 0.0;
  int network = 0;
  Eigen::Ref<const Eigen::VectorXd> features;
  Eigen::Ref<const Eigen::VectorXd> target_Nm;
};

class Adapter {
 public:
  // Throws std::invalid_argument: no readout, figures out of range.
  Adapter(const AdapterConfig& config, const std::optional<Eigen::MatrixXd>& sea_readout,
          const std::optional<Eigen::MatrixXd>& pea_readout);

  // A new session: offline readouts, nothing excited.
  void Reset() noexcept;

  // A standby's: the owner's readout of a network, from which this one goes on. False, and nothing
  // changed: no such network here, or it does not fit.
  [[nodiscard]] bool Adopt(int network, std::uint64_t version,
                           const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept;

  Frozen Step(const Observation& observation) noexcept;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  // The network of the last usable sample; at the start one that is there.
  int network() const noexcept { return network_; }
  bool has(int network) const noexcept {
    return slots_[static_cast<std::size_t>(network)].has_value();
  }
  const RecursiveLeastSquares& estimator(int network) const {
    return slots_[static_cast<std::size_t>(network)]->estimator;
  }
  std::uint64_t version(int network) const {
    return slots_[static_cast<std::size_t>(network)]->version;
  }

 private:
  struct Slot {
    RecursiveLeastSquares estimator;
    std::uint64_t version = 0;

    void Exchange(types::StateArchive& archive);
  };

  AdapterConfig config_;
  std::array<std::optional<Slot>, 2> slots_;
  int network_ = 0;
  std::uint64_t updates_ = 0;
  double still_s_ = 0.0;
};

}  // namespace sinew::rls
