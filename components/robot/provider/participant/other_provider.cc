#include "components/robot/provider/participant/other_provider.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/topics.h"

namespace sinew::provider {

bool MustEnd(const RunningSession& own, const RunningSession& other) {
  if (std::abs(own.age_s - other.age_s) < kSameAge_s) return own.session_id > other.session_id;
  return own.age_s < other.age_s;
}

std::optional<std::string> OtherProvider::Name() const {
  for (const node::Endpoint& endpoint : node_.Endpoints()) {
    if (endpoint.is_writer && endpoint.topic == node::kJointState.name) return endpoint.participant;
  }
  return std::nullopt;
}

void OtherProvider::Refuse(std::chrono::milliseconds limit, const node::StopFlag& stop) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < deadline && !stop.requested()) {
    if (const auto name = Name()) {
      throw UsageError("domain " + std::to_string(node_.options().domain_id) +
                       " already has a state provider: '" + *name +
                       "'; stop it or use another --domain");
    }
    node_.WaitForData(std::chrono::milliseconds(50));
  }
}

void OtherProvider::Watch(const RunningSession& own) {
  if (changes_ != node_.EndpointChanges()) {
    changes_ = node_.EndpointChanges();
    const auto name = Name();
    if (!name) {
      states_.reset();
    } else if (!states_) {
      name_ = *name;
      spdlog::error("another state provider in this domain: '{}'; the younger one ends", name_);
      states_.emplace(node_.MakeReader(node::kJointState));
    }
  }
  if (!states_) return;
  while (const auto state = states_->TakeNext()) {
    const auto& header = state->header;
    if (header.session_id == own.session_id || header.origin == msg::Origin::kReplay) continue;
    const double age_s = static_cast<double>(header.tick) * state->period_s;
    if (!MustEnd(own, {header.session_id, age_s})) continue;
    throw std::runtime_error("this domain has an older state provider, '" + name_ +
                             "', that was not heard at the start: this one ends");
  }
}

}  // namespace sinew::provider
