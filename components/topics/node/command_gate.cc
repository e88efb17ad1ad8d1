#include "components/topics/node/command_gate.h"

#include <spdlog/spdlog.h>

namespace sinew::node {

void CommandGate::Refuse(const std::string& why) {
  ++refused_;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_line_) return;
  next_line_ = now + std::chrono::seconds(1);
  spdlog::warn("{} refused: {} ({} since the start)", what_, why, refused_);
}

}  // namespace sinew::node
