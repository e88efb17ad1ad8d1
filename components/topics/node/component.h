// A participant's work as an object: looped over by its own main(), or cycle by cycle beside others
// in one thread (composition.h).
//
// It owns its node; component_status says that it stopped when it ends. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace sinew::node {

// A component's state between two cycles, from a component_snapshot.
struct SavedState {
  std::uint32_t version = 0;
  std::span<const std::byte> content;
};

class Component {
 public:
  virtual ~Component() = default;
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  virtual bool Ready() = 0;  // TickLoop::Ready
  // One cycle, waited for. False: stop was requested or the session ended.
  virtual bool Step() = 0;
  // Takes the cycle that waits as done, and goes on from the state after it. Throws
  // std::invalid_argument: not a state of this component with this configuration (it is then to be
  // thrown away), or no cycle waits.
  virtual void Resume(const SavedState&) {
    throw std::invalid_argument("this component has no state to go on from");
  }

  void Run() {
    while (Step()) {
    }
  }

 protected:
  Component() = default;
};

}  // namespace sinew::node
