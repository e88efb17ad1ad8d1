// A participant's work as an object: looped over by its own main(), or cycle by cycle beside others
// in one thread (composition.h).
//
// It owns its node; component_status says that it stopped when it ends. Thread: one.
#pragma once

namespace sinew::node {

class Component {
 public:
  virtual ~Component() = default;
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  virtual bool Ready() = 0;  // TickLoop::Ready
  // One cycle, waited for. False: stop was requested or the session ended.
  virtual bool Step() = 0;

  void Run() {
    while (Step()) {
    }
  }

 protected:
  Component() = default;
};

}  // namespace sinew::node
