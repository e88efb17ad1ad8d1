// Another state provider of the domain: its joint_state would mix with ours. One that is known
// before the first cycle keeps this one from starting; one that discovery finds later, as after
// lost datagrams, ends when it is the younger of the two, and otherwise this one does.
//
// One thread, that of the cycle.
#pragma once

#include <sinew_idl/joint.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "components/topics/node/node.h"
#include "components/topics/node/options.h"

namespace sinew::provider {

// A session of a state provider, and how long it has run by its ticks: no clock of two hosts
// counts.
struct RunningSession {
  std::uint64_t session_id = 0;
  double age_s = 0.0;
};

// Ages are known as well as messages are fast; closer ones are the same.
inline constexpr double kSameAge_s = 0.1;

// Whether `own` is the one that ends: the younger, and of the same age that of the higher number.
bool MustEnd(const RunningSession& own, const RunningSession& other);

class OtherProvider {
 public:
  explicit OtherProvider(node::Node& node) : node_(node) {}

  // Looks for that time, or until a stop is asked for. Throws UsageError: there is one.
  void Refuse(std::chrono::milliseconds limit, const node::StopFlag& stop);
  // Every cycle; waits for nothing. Throws std::runtime_error: there is one, and own must end.
  void Watch(const RunningSession& own);

 private:
  std::optional<std::string> Name() const;  // of the other's participant

  node::Node& node_;
  std::uint64_t changes_ = 0;  // of discovery that were looked at
  std::string name_;
  std::optional<node::Reader<msg::JointState>> states_;  // while there is another one
};

}  // namespace sinew::provider
