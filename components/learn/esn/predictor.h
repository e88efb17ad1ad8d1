// The network chosen by regime: SEA inside the backlash, PEA outside.
//
// Both networks are stepped every tick, so that the one that takes over has run in. Which counts:
//  - two networks: the one of the regime; none while the regime is unknown (never a guess);
//  - one network: that one in every regime, known or not; it then speaks for both (sea_torque_Nm,
//    pea_torque_Nm). It is meant for all of the motion, or for robots without free play, and needs
//    no regime detector.
//
// The first input that a network has settles it (Network::Settle): a robot that begins at rest is
// not moved by a reservoir that runs in.
//
// A network that lacks an input (a signal that is not a number) has no prediction in that tick and
// keeps its state.
//
// One thread. No memory is taken in Step.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "components/base/types/joints.h"
#include "components/base/types/regime.h"
#include "components/learn/esn/network.h"
#include "components/learn/esn/signals.h"
#include "components/learn/esn/weights.h"

namespace sinew::esn {

enum class Which : std::uint8_t { kSea = 0, kPea = 1 };

struct Prediction {
  int joint_count = 0;
  types::JointArray<double> torque_Nm{};      // of the chosen network; 0 where not valid
  types::JointArray<double> sea_torque_Nm{};  // of each, chosen or not; 0 where it has none
  types::JointArray<double> pea_torque_Nm{};
  types::JointArray<bool> valid{};
  std::optional<Which> chosen;  // nothing: no valid prediction
};

class Predictor {
 public:
  // Throws std::invalid_argument: no network; two networks that do not have one output each;
  // periods that differ; inputs without names; a target that is not drive_torque_Nm.
  Predictor(const std::optional<Weights>& sea, const std::optional<Weights>& pea);

  void Reset() noexcept;
  Prediction Step(const Frame& frame, types::Regime regime) noexcept;

  // False, and nothing changes: no such network, wrong shape, not finite.
  [[nodiscard]] bool SetReadout(Which which, std::uint64_t version,
                                const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  bool has(Which which) const noexcept { return slots_[Index(which)].has_value(); }
  bool needs_regime() const noexcept { return needs_regime_; }
  double period_s() const noexcept { return period_s_; }
  int output_count() const noexcept { return outputs_; }
  // Only for a network that is there.
  const Network& network(Which which) const { return slots_[Index(which)]->network; }
  std::uint64_t readout_version(Which which) const { return slots_[Index(which)]->version; }

 private:
  struct Slot {
    Network network;
    std::vector<Input> inputs;
    Eigen::VectorXd u;
    std::uint64_t version = 0;
    bool good = false;
    bool settled = false;  // has had an input

    void Exchange(types::StateArchive& archive);
  };
  static std::size_t Index(Which which) { return static_cast<std::size_t>(which); }

  std::array<std::optional<Slot>, 2> slots_;
  bool needs_regime_ = false;
  double period_s_ = 0.0;
  int outputs_ = 0;
};

}  // namespace sinew::esn
