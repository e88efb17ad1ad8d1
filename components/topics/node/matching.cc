#include "components/topics/node/matching.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>

#include "components/base/types/text.h"

namespace sinew::node {

namespace {

std::string Milliseconds(std::chrono::nanoseconds duration) {
  if (duration == kUnlimited) return "none";
  return types::Text("%g ms", static_cast<double>(duration.count()) * 1e-6);
}

std::string ReliabilityText(const EndpointQos& qos) {
  return qos.reliable ? "reliable" : "best-effort";
}

std::string DurabilityText(const EndpointQos& qos) {
  switch (qos.durability) {
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

std::string OwnershipText(const EndpointQos& qos) { return qos.exclusive ? "exclusive" : "shared"; }
std::string DeadlineText(const EndpointQos& qos) { return Milliseconds(qos.deadline); }
std::string BudgetText(const EndpointQos& qos) { return Milliseconds(qos.latency_budget); }

std::string LivelinessText(const EndpointQos& qos) {
  switch (qos.liveliness) {
    case EndpointQos::Liveliness::kAutomatic:
      return "automatic";
    case EndpointQos::Liveliness::kManualByParticipant:
      return "manual-by-participant";
    case EndpointQos::Liveliness::kManualByTopic:
      return "manual-by-topic";
  }
  return "unknown";
}

std::string LeaseText(const EndpointQos& qos) { return Milliseconds(qos.lease); }

std::string OrderText(const EndpointQos& qos) {
  return qos.by_source_stamp ? "by source stamp" : "by reception";
}

std::string PresentationText(const EndpointQos& qos) {
  constexpr std::array<const char*, 3> kScopes = {"instance", "topic", "group"};
  std::string text = kScopes.at(static_cast<std::size_t>(qos.access_scope));
  if (qos.coherent_access) text += " coherent";
  if (qos.ordered_access) text += " ordered";
  return text;
}

bool PresentationFits(const EndpointQos& offered, const EndpointQos& requested) {
  return offered.access_scope >= requested.access_scope &&
         (offered.coherent_access || !requested.coherent_access) &&
         (offered.ordered_access || !requested.ordered_access);
}

std::vector<EndpointQos::Representation> RepresentationsOf(const EndpointQos& qos) {
  if (qos.representations.empty()) return {EndpointQos::Representation::kXcdr1};
  return qos.representations;
}

std::string RepresentationText(const EndpointQos& qos) {
  std::string text;
  for (const EndpointQos::Representation representation : RepresentationsOf(qos)) {
    constexpr std::array<const char*, 3> kNames = {"XCDR1", "XML", "XCDR2"};
    if (!text.empty()) text += " or ";
    text += kNames.at(static_cast<std::size_t>(representation));
  }
  return text;
}

bool RepresentationFits(const EndpointQos& offered, const EndpointQos& requested) {
  const auto accepted = RepresentationsOf(requested);
  return std::find(accepted.begin(), accepted.end(), RepresentationsOf(offered).front()) !=
         accepted.end();
}

struct PolicyRule {
  const char* policy;
  const char* label;       // in front of the value, where that alone says too little
  bool fast_dds_compares;  // EDP.cpp of 2.9.1, validMatching
  std::string (*text)(const EndpointQos&);
  bool (*fits)(const EndpointQos& offered, const EndpointQos& requested);
};

// Rules of the table of QoS policies in OMG DDS 1.4, 2.2.3: those of which a writer offers and a
// reader requests something ("RxO"); the last one is of XTypes 1.3.
constexpr PolicyRule kPolicyRules[] = {
    {"reliability", "", true, ReliabilityText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.reliable || !requested.reliable;
     }},
    {"durability", "", true, DurabilityText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.durability >= requested.durability;
     }},
    {"ownership", "", true, OwnershipText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.exclusive == requested.exclusive;
     }},
    {"deadline", "deadline ", true, DeadlineText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.deadline <= requested.deadline;
     }},
    {"liveliness", "liveliness ", true, LivelinessText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.liveliness >= requested.liveliness;
     }},
    {"liveliness lease", "lease ", true, LeaseText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.lease <= requested.lease;
     }},
    {"latency budget", "latency budget ", false, BudgetText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.latency_budget <= requested.latency_budget;
     }},
    {"destination order", "", false, OrderText,
     [](const EndpointQos& offered, const EndpointQos& requested) {
       return offered.by_source_stamp || !requested.by_source_stamp;
     }},
    {"presentation", "presentation ", false, PresentationText, PresentationFits},
    {"data representation", "", false, RepresentationText, RepresentationFits},
};

// The first two bytes of a GUID are the vendor (RTPS 2.3, 8.2.4.2): 01.0f is eProsima.
bool IsOfFastDds(const Endpoint& endpoint) { return endpoint.guid.starts_with("01.0f."); }

// As Fast DDS compares them: the default partition and the name "" are one; of two names each may
// be a pattern of POSIX fnmatch.
bool PartitionsMeet(const EndpointQos& a, const EndpointQos& b) {
  const auto& names = a.partitions;
  const auto& others = b.partitions;
  if (names.empty() && others.empty()) return true;
  if (names.empty() || others.empty()) {
    const auto& named = names.empty() ? others : names;
    return std::find(named.begin(), named.end(), "") != named.end();
  }
  for (const std::string& name : names) {
    for (const std::string& other : others) {
      if (::fnmatch(name.c_str(), other.c_str(), FNM_NOESCAPE) == 0 ||
          ::fnmatch(other.c_str(), name.c_str(), FNM_NOESCAPE) == 0) {
        return true;
      }
    }
  }
  return false;
}

std::string PartitionText(const EndpointQos& qos) {
  if (qos.partitions.empty()) return "the default partition";
  std::string text = qos.partitions.size() == 1 ? "partition " : "partitions ";
  for (const std::string& name : qos.partitions) {
    text += (&name == qos.partitions.data() ? "'" : ", '") + name + "'";
  }
  return text;
}

}  // namespace

std::string DescribeQos(const EndpointQos& qos) {
  std::string text = ReliabilityText(qos);
  EndpointQos standard;
  standard.reliable = qos.reliable;
  for (const PolicyRule& rule : kPolicyRules) {
    const std::string value = rule.text(qos);
    if (value != rule.text(standard)) text += std::string(", ") + rule.label + value;
  }
  if (!qos.partitions.empty()) text += ", " + PartitionText(qos);
  return text;
}

std::vector<std::string> WhyNotMatched(const Endpoint& writer, const Endpoint& reader) {
  std::vector<std::string> reasons;
  if (writer.type_name != reader.type_name) {
    reasons.push_back("type: the writer's is " + writer.type_name + ", the reader's " +
                      reader.type_name);
  }
  EndpointQos offered = writer.qos;
  if (offered.representations.size() > 1) offered.representations.resize(1);
  const bool both_of_fast_dds = IsOfFastDds(writer) && IsOfFastDds(reader);
  for (const PolicyRule& rule : kPolicyRules) {
    if (both_of_fast_dds && !rule.fast_dds_compares) continue;
    if (rule.fits(offered, reader.qos)) continue;
    reasons.push_back(std::string(rule.policy) + ": the writer offers " + rule.text(offered) +
                      ", the reader asks for " + rule.text(reader.qos));
  }
  if (!PartitionsMeet(writer.qos, reader.qos)) {
    reasons.push_back("partition: the writer is in " + PartitionText(writer.qos) +
                      ", the reader in " + PartitionText(reader.qos));
  }
  return reasons;
}

}  // namespace sinew::node
