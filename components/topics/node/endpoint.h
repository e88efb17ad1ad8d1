// A writer or a reader somewhere in a domain, as discovery reports it. Needs no DDS.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace sinew::node {

inline constexpr std::chrono::nanoseconds kUnlimited = std::chrono::nanoseconds::max();

// The policies that decide whether a writer and a reader match (matching.h): OMG DDS 1.4, 2.2.3,
// and of XTypes 1.3 the data representation. Defaults are those of DDS.
struct EndpointQos {
  enum class Durability { kVolatile, kTransientLocal, kTransient, kPersistent };  // weakest first
  enum class Liveliness { kAutomatic, kManualByParticipant, kManualByTopic };     // weakest first
  enum class AccessScope { kInstance, kTopic, kGroup };                           // weakest first
  enum class Representation { kXcdr1 = 0, kXml = 1, kXcdr2 = 2 };  // XTypes 1.3, 7.6.3.1.1

  bool reliable = false;
  Durability durability = Durability::kVolatile;
  bool exclusive = false;  // ownership
  std::chrono::nanoseconds deadline = kUnlimited;
  std::chrono::nanoseconds latency_budget{0};
  Liveliness liveliness = Liveliness::kAutomatic;
  std::chrono::nanoseconds lease = kUnlimited;  // of liveliness
  bool by_source_stamp = false;                 // destination order; else by reception
  AccessScope access_scope = AccessScope::kInstance;
  bool coherent_access = false, ordered_access = false;
  std::vector<std::string> partitions;          // of publisher or subscriber; none: the default one
  std::vector<Representation> representations;  // none: XCDR1; a writer uses the first one
};

struct Endpoint {
  bool is_writer = false;
  std::string topic;  // as in topics.h, whatever its name on the wire; of a foreign one that name
  std::string type_name;
  std::string participant;
  std::string guid;            // "01.0f. ... |0.0.1.3"; in front of '|' that of the participant
  std::uint32_t strength = 0;  // of writers of EXCLUSIVE topics: the greatest one is heard
  EndpointQos qos{};
  // Addresses of its participant, but for loopback, and for addresses of this host.
  std::vector<std::string> addresses = {};
};

// The part of the GUID that all endpoints of a participant have in common.
inline std::string ParticipantId(const Endpoint& endpoint) {
  return endpoint.guid.substr(0, endpoint.guid.find('|'));
}

}  // namespace sinew::node
