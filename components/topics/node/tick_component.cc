#include "components/topics/node/tick_component.h"

#include <spdlog/spdlog.h>

#include <stdexcept>

namespace sinew::node {

bool TickComponent::Step() {
  auto tick = loop_.Next();
  if (!tick) return false;
  Compute(*tick);
  if (save_) save_(*tick);
  return true;
}

void TickComponent::Resume(const SavedState& saved) {
  if (!restore_) return Component::Resume(saved);
  if (!loop_.Ready() || !loop_.Next()) {
    throw std::invalid_argument("no cycle waits, expected the one of the snapshot");
  }
  restore_(saved);
}

void TickComponent::Report(const std::string& trouble) {
  if (trouble == reported_) return;
  reported_ = trouble;
  if (!trouble.empty()) spdlog::error("{}", trouble);
  node_.SetState(trouble.empty() ? Node::State::kActive : Node::State::kFault, trouble);
}

}  // namespace sinew::node
