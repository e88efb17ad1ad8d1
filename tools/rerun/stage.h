// One component of a robot, alone in a composition apart (components/topics/node/composition.h): it
// gets what it is fed, cycle by cycle, without DDS and clock. Thread: one.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/record/recording/idl_schema.h"
#include "components/topics/node/component.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/node.h"
#include "tools/compose/chain.h"

namespace sinew::rerun {

class Stage {
 public:
  // `mode`: that of the recording. `stop` outlives it. Throws UsageError as compose::MakePart.
  Stage(const compose::Part& part, node::TimeMode mode, node::StopFlag& stop);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const std::string& name() const { return name_; }
  const std::string& kind() const { return kind_; }  // "control"
  // Topics that it reads, and those that it may write.
  const std::vector<std::string>& inputs() const { return inputs_; }
  const std::vector<std::string>& outputs() const { return outputs_; }
  bool Reads(std::string_view topic) const;

  void Feed(const std::string& topic, std::span<const std::byte> payload);
  // Whether it stands by in its next cycles, as in a participant's first second (Tick::settled).
  void SetJoining(bool joining) { composition_.SetSettled(!joining); }
  // One cycle, with what was fed. False: no cycle had begun, or its session has ended.
  bool Step();
  // The cycle with what was fed is over, and this the state after it. Throws std::invalid_argument.
  void Resume(const node::SavedState& state) { component_->Resume(state); }
  // Output of the last cycle, canonical; nullptr: it wrote nothing there.
  const node::Bytes* Output(std::string_view topic) const;

 private:
  const std::string name_, kind_;
  node::Composition composition_{node::Composition::Reach::kApart};
  std::unique_ptr<node::Component> component_;
  std::vector<std::string> inputs_, outputs_;
  std::unique_ptr<node::Node> outside_;  // feeds it and hears it
  std::map<std::string, node::RawWriter, std::less<>> feeds_;
  std::map<std::string, node::Bytes, std::less<>> written_;
};

// The type of a topic of this build; parsed once. Throws std::invalid_argument: no such topic.
const recording::IdlType& TypeOf(std::string_view topic);

}  // namespace sinew::rerun
