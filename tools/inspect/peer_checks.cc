#include "tools/inspect/peer_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "components/node/matching.h"

namespace sinew::inspect {

namespace {

// A cycle of the rig (240 Hz): with a larger offset, stamps of two hosts put cycles in a wrong
// order.
constexpr double kMostOffset_ms = 1000.0 / 240.0;

std::string ParticipantOf(const node::Endpoint& endpoint) {
  return endpoint.guid.substr(0, endpoint.guid.find('|'));
}

}  // namespace

std::vector<Mismatch> Mismatches(const std::vector<node::Endpoint>& endpoints) {
  std::vector<Mismatch> found;
  for (const node::Endpoint& writer : endpoints) {
    if (!writer.is_writer) continue;
    for (const node::Endpoint& reader : endpoints) {
      if (reader.is_writer || reader.topic != writer.topic ||
          ParticipantOf(reader) == ParticipantOf(writer)) {
        continue;
      }
      std::vector<std::string> reasons = node::WhyNotMatched(writer, reader);
      if (!reasons.empty()) found.push_back({writer, reader, std::move(reasons)});
    }
  }
  return found;
}

std::vector<Finding> CheckPeers(const std::vector<node::Endpoint>& endpoints,
                                const std::vector<std::string>& problems) {
  std::vector<Finding> findings;
  std::set<std::string> participants;
  for (const node::Endpoint& endpoint : endpoints) participants.insert(ParticipantOf(endpoint));
  findings.reserve(problems.size());
  for (const std::string& problem : problems) {
    findings.push_back({"participants", Severity::kFault, problem, "rebuild all from one source"});
  }
  for (const Mismatch& mismatch : Mismatches(endpoints)) {
    for (const std::string& reason : mismatch.reasons) {
      findings.push_back({"matching", Severity::kFault,
                          "topic '" + mismatch.writer.topic + "': '" + mismatch.writer.participant +
                              "' is not heard by '" + mismatch.reader.participant + "': " + reason,
                          "the same build, the same --qos file and time mode for all"});
    }
  }
  if (findings.empty()) {
    findings.push_back({"matching", Severity::kOk,
                        std::to_string(participants.size()) + " participants, " +
                            std::to_string(endpoints.size()) + " endpoints, all match",
                        ""});
  }
  return findings;
}

std::vector<Finding> CheckClocks(const std::vector<ClockSample>& samples,
                                 const std::string& own_host) {
  std::map<std::string, double> least_ms;
  for (const ClockSample& sample : samples) {
    const double difference_ms = static_cast<double>(sample.arrived_ns - sample.sent_ns) * 1e-6;
    const auto [at, is_new] = least_ms.try_emplace(sample.host, difference_ms);
    if (!is_new) at->second = std::min(at->second, difference_ms);
  }
  std::vector<Finding> findings;
  for (const auto& [host, difference_ms] : least_ms) {
    if (host == own_host) continue;
    char text[160];
    if (std::abs(difference_ms) <= kMostOffset_ms) {
      std::snprintf(text, sizeof(text), "host '%s': at most %.2f ms from this one", host.c_str(),
                    std::abs(difference_ms));
      findings.push_back({"clocks", Severity::kOk, text, ""});
      continue;
    }
    if (difference_ms < 0.0) {
      std::snprintf(text, sizeof(text), "the clock of host '%s' is ahead by at least %.1f ms",
                    host.c_str(), -difference_ms);
    } else {
      std::snprintf(text, sizeof(text),
                    "messages of host '%s' arrive %.1f ms after they were sent, at least",
                    host.c_str(), difference_ms);
    }
    findings.push_back({"clocks", Severity::kWarning, text,
                        "chrony or PTP on both hosts: stamps of recordings are of two clocks"});
  }
  if (findings.empty()) {
    findings.push_back({"clocks", Severity::kOk, "all participants are on this host", ""});
  }
  return findings;
}

}  // namespace sinew::inspect
