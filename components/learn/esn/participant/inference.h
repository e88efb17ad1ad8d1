// One tick of sinew-esn: messages in, messages out.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>

#include <cstdint>
#include <optional>

#include "components/learn/esn/file/esn_config.h"
#include "components/learn/esn/inverse_dynamics.h"
#include "components/learn/esn/predictor.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::esn {

struct Outputs {
  msg::TorquePrediction prediction;
  msg::ReservoirState reservoir;
};

class Inputs;

class Inference {
 public:
  explicit Inference(const EsnConfig& config);  // throws UsageError

  Outputs Step(const Inputs& inputs, const node::Tick& tick);

  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  // Topics that the networks read; others need not exist in the deployment.
  bool needs_actuator_state() const { return needs_actuator_state_; }
  bool needs_reference() const { return needs_reference_; }
  bool needs_regime() const { return needs_regime_; }
  bool needs_readout() const { return needs_readout_; }
  std::uint64_t readouts_taken() const { return readouts_taken_; }
  std::uint64_t readouts_refused() const { return readouts_refused_; }

 private:
  std::optional<Predictor> predictor_;
  std::optional<InverseDynamics> inverse_;
  bool needs_actuator_state_ = true;
  bool needs_reference_ = true;
  bool needs_regime_ = false;
  bool needs_readout_ = false;
  std::uint64_t session_id_ = 0;
  std::uint64_t readouts_taken_ = 0;
  std::uint64_t readouts_refused_ = 0;
};

// The topics of the loop. joint_state is the trigger; readout is that of the tick before.
class Inputs {
 public:
  Inputs(node::TickLoop& loop, const Inference& inference)
      : state(loop.AddInput(node::kJointState)),
        actuator(Add(loop, node::kActuatorState, inference.needs_actuator_state())),
        reference(Add(loop, node::kReference, inference.needs_reference())),
        regime(Add(loop, node::kRegime, inference.needs_regime())),
        readout(Add(loop, node::kReadout, inference.needs_readout(), 1)) {}

  // Null: not read.
  node::TickInput<msg::JointState>& state;
  node::TickInput<msg::ActuatorState>* actuator;
  node::TickInput<msg::Reference>* reference;
  node::TickInput<msg::RegimeState>* regime;
  node::TickInput<msg::Readout>* readout;

 private:
  template <class Message>
  static node::TickInput<Message>* Add(node::TickLoop& loop, const node::Topic<Message>& topic,
                                       bool wanted, int delay_ticks = 0) {
    return wanted ? &loop.AddInput(topic, {.delay_ticks = delay_ticks}) : nullptr;
  }
};

}  // namespace sinew::esn
