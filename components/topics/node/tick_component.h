// The skeleton of a participant that computes once a tick: waits for it, computes, leaves snapshots
// of its state, and says in component_status and in the log what keeps it from its work.
//
//   class Regime final : public node::TickComponent {
//     Regime(...) : TickComponent(options, stop) { Keep(kStateVersion, &detector_); }
//     void Compute(node::Tick& tick) override { loop().Publish(output_, ..., tick); }
//   };
//
// Thread: one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "components/topics/node/component.h"
#include "components/topics/node/node.h"
#include "components/topics/node/snapshot.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::node {

class TickComponent : public Component {
 public:
  bool Ready() final { return loop_.Ready(); }
  bool Step() final;
  void Resume(const SavedState& saved) final;

 protected:
  // joint_names: those of its commands (node.h). Throws DdsError.
  TickComponent(const Options& options, StopFlag& stop,
                const std::vector<std::string>& joint_names = {})
      : node_(options, joint_names), loop_(node_, stop) {}

  // All outputs of the tick are published here.
  virtual void Compute(Tick& tick) = 0;

  // The state that snapshots hold, with Exchange(types::StateArchive&); called in the constructor.
  // version: of its fields and of all that they contain.
  template <class State>
  void Keep(std::uint32_t version, State* state) {
    const auto snapshots = std::make_shared<Snapshots<State>>(node_, version, state);
    save_ = [snapshots](const Tick& tick) { snapshots->Cycle(tick); };
    restore_ = [snapshots](const SavedState& saved) { snapshots->Restore(saved); };
  }

  // In a fault while there is trouble, in words. Logged when it changes.
  void Report(const std::string& trouble);

  Node& node() { return node_; }
  TickLoop& loop() { return loop_; }

 private:
  Node node_;
  TickLoop loop_;
  std::function<void(const Tick&)> save_;
  std::function<void(const SavedState&)> restore_;
  std::string reported_;
};

}  // namespace sinew::node
