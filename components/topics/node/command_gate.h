// The rule of components/base/types/command_rule.h at a reader of a commanding topic: what it
// refuses is counted and logged.
//
// One thread. Logs the first refusal at once, then at most one line a second.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "components/base/types/command_rule.h"

namespace sinew::node {

class CommandGate {
 public:
  // what: what is refused, e.g. the topic.
  explicit CommandGate(std::string what) : what_(std::move(what)) {}

  // True: the message counts.
  bool Admits(types::CommandKind kind, const types::MessageHeader& header,
              const types::RunningSession& running) {
    const types::CommandRefusal refusal = types::RefusalOf(kind, header, running);
    if (refusal == types::CommandRefusal::kNone) return true;
    Refuse(types::RefusalText(refusal));
    return false;
  }
  // Counts and logs a refusal of another reason.
  void Refuse(const std::string& why);
  std::uint64_t refused() const { return refused_; }

 private:
  std::string what_;
  std::uint64_t refused_ = 0;
  std::chrono::steady_clock::time_point next_line_{};
};

}  // namespace sinew::node
