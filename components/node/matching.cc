#include "components/node/matching.h"

#include <array>
#include <cstdio>

namespace sinew::node {

namespace {

const char* DurabilityName(EndpointQos::Durability durability) {
  switch (durability) {
    case EndpointQos::Durability::kVolatile:
      return "volatile";
    case EndpointQos::Durability::kTransientLocal:
      return "transient-local";
    case EndpointQos::Durability::kTransient:
      return "transient";
    case EndpointQos::Durability::kPersistent:
      return "persistent";
  }
  return "unknown";
}

const char* ReliabilityName(bool reliable) { return reliable ? "reliable" : "best-effort"; }
const char* OwnershipName(bool exclusive) { return exclusive ? "exclusive" : "shared"; }

std::string DeadlineText(std::chrono::nanoseconds deadline) {
  if (deadline == kNoDeadline) return "no deadline";
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "deadline %g ms",
                static_cast<double>(deadline.count()) * 1e-6);
  return text.data();
}

std::string Mismatch(const std::string& offered, const std::string& requested) {
  return "the writer offers " + offered + ", the reader asks for " + requested;
}

}  // namespace

std::string DescribeQos(const EndpointQos& qos) {
  std::string text = ReliabilityName(qos.reliable);
  text += std::string(", ") + DurabilityName(qos.durability);
  if (qos.exclusive) text += ", exclusive";
  if (qos.deadline != kNoDeadline) text += ", " + DeadlineText(qos.deadline);
  return text;
}

std::vector<std::string> WhyNotMatched(const Endpoint& writer, const Endpoint& reader) {
  std::vector<std::string> reasons;
  const EndpointQos& offered = writer.qos;
  const EndpointQos& requested = reader.qos;
  if (writer.type_name != reader.type_name) {
    reasons.push_back("the writer's type is " + writer.type_name + ", the reader's " +
                      reader.type_name);
  }
  if (requested.reliable && !offered.reliable) {
    reasons.push_back(Mismatch(ReliabilityName(false), ReliabilityName(true)));
  }
  if (offered.durability < requested.durability) {
    reasons.push_back(
        Mismatch(DurabilityName(offered.durability), DurabilityName(requested.durability)));
  }
  if (offered.exclusive != requested.exclusive) {
    reasons.push_back(Mismatch(std::string(OwnershipName(offered.exclusive)) + " ownership",
                               OwnershipName(requested.exclusive)));
  }
  if (offered.deadline > requested.deadline) {
    reasons.push_back(Mismatch(DeadlineText(offered.deadline), DeadlineText(requested.deadline)));
  }
  return reasons;
}

}  // namespace sinew::node
