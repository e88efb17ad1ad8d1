#include "tools/inspect/peer_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "components/base/types/joined.h"
#include "components/base/types/text.h"
#include "components/topics/node/matching.h"

namespace sinew::inspect {

namespace {

// A cycle of the rig (240 Hz): with a larger offset, stamps of two hosts put cycles in a wrong
// order.
constexpr double kMostOffset_ms = 1000.0 / 240.0;

constexpr double kMostLost = 0.02;

// difference_ms: the least one of arrival - sending.
Finding CheckClock(const std::string& host, std::optional<double> difference_ms) {
  const std::string name = "host '" + host + "'";
  if (!difference_ms) {
    return {"clocks", Severity::kNote,
            name + ": its clock was not compared, no new component_status",
            "a longer --wait; a participant whose loop hangs sends none"};
  }
  if (std::abs(*difference_ms) <= kMostOffset_ms) {
    return {"clocks", Severity::kOk,
            name + types::Text(": messages arrive %.2f ms after they were sent, the clocks agree",
                               *difference_ms),
            ""};
  }
  const std::string advice =
      "synchronise both hosts with chrony (chronyc tracking shows the offset) or PTP: recordings "
      "hold stamps of both";
  const std::string text = types::Text("%.1f ms", std::abs(*difference_ms));
  if (*difference_ms < 0.0) {
    return {"clocks", Severity::kWarning,
            "the clock of " + name + " is ahead of this one by at least " + text, advice};
  }
  return {"clocks", Severity::kWarning,
          "the clock of " + name + " is behind this one by at most " + text +
              ", or its messages take that long",
          advice};
}

}  // namespace

std::vector<Mismatch> Mismatches(const std::vector<node::Endpoint>& endpoints) {
  std::vector<Mismatch> found;
  for (const node::Endpoint& writer : endpoints) {
    if (!writer.is_writer) continue;
    for (const node::Endpoint& reader : endpoints) {
      if (reader.is_writer || reader.topic != writer.topic ||
          node::ParticipantId(reader) == node::ParticipantId(writer)) {
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
  for (const node::Endpoint& endpoint : endpoints)
    participants.insert(node::ParticipantId(endpoint));
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
                        "participants: " + std::to_string(participants.size()) +
                            ", endpoints: " + std::to_string(endpoints.size()) + ", all match",
                        ""});
  }
  return findings;
}

Finding CheckOpenness(const Openness& own, const std::vector<node::Endpoint>& endpoints) {
  if (own.has_keys) {
    return {"network", Severity::kOk,
            "with a key or DDS security: whoever lacks it is not heard and hears nothing", ""};
  }
  std::set<std::string> open, tunnelled;
  const auto add = [&](const std::string& text, auto is_of) {
    const bool in_tunnel = std::any_of(own.tunnels.begin(), own.tunnels.end(), is_of);
    (in_tunnel ? tunnelled : open).insert(text);
  };
  for (const node::Endpoint& endpoint : endpoints) {
    for (const std::string& address : endpoint.addresses) {
      add("'" + endpoint.participant + "' on " + address, [&address](const auto& tunnel) {
        return node::internal::IsOfNetwork(tunnel, node::internal::NumberOf(address));
      });
    }
  }
  for (const std::string& interface : own.interfaces) {
    if (interface == "lo") continue;
    add("programs of this shell on " + interface,
        [&interface](const auto& tunnel) { return tunnel.interface == interface; });
  }
  if (open.empty()) {
    const std::string here = own.isolated.empty() ? "every user of this host"
                                                  : "in the network of deployment '" +
                                                        own.isolated + "' its user and root";
    if (tunnelled.empty()) {
      return {"network", Severity::kOk,
              "loopback alone: " + here + ", and nobody else, can command the robot", ""};
    }
    return {"network", Severity::kOk,
            "through WireGuard: " + types::Joined(tunnelled) +
                "; whoever has a key of the tunnel, and " + here + ", can command the robot",
            ""};
  }
  return {"network", Severity::kWarning,
          "open without a key or DDS security: " + types::Joined(open) +
              "; whoever reaches that network can arm, move and stop the robot, and reads all "
              "that it publishes",
          "sinew security init DEPLOYMENT, or a key: docs/how-to/several-hosts.md"};
}

std::vector<Finding> CheckClocks(const std::vector<ClockSample>& samples,
                                 const std::string& own_host) {
  if (samples.empty()) {
    return {
        {"clocks", Severity::kNote, "no component_status was received, no clock was compared",
         "is discovery let through and data not? UDP on all ports (docs/how-to/several-hosts.md)"}};
  }
  std::map<std::string, std::optional<double>> least_ms;  // none: only samples from history
  for (const ClockSample& sample : samples) {
    if (sample.host == own_host) continue;
    std::optional<double>& least = least_ms[sample.host];
    if (sample.from_history) continue;
    const double difference_ms = static_cast<double>(sample.arrived_ns - sample.sent_ns) * 1e-6;
    least = std::min(least.value_or(difference_ms), difference_ms);
  }
  std::vector<Finding> findings;
  findings.reserve(least_ms.size());
  for (const auto& [host, difference_ms] : least_ms) {
    findings.push_back(CheckClock(host, difference_ms));
  }
  if (findings.empty()) {
    findings.push_back({"clocks", Severity::kOk, "all participants are on this host", ""});
  }
  return findings;
}

std::vector<Finding> CheckLosses(const std::vector<Loss>& losses) {
  std::vector<Finding> findings;
  for (const Loss& loss : losses) {
    if (loss.sent == 0) continue;
    const double share = static_cast<double>(loss.lost) / static_cast<double>(loss.sent);
    const std::string text =
        types::Text(": %llu of %llu lost (%.1f %%)", static_cast<unsigned long long>(loss.lost),
                    static_cast<unsigned long long>(loss.sent), 100.0 * share);
    if (share <= kMostLost) {
      findings.push_back({"losses", Severity::kOk, loss.what + text, ""});
    } else {
      findings.push_back({"losses", Severity::kWarning, loss.what + text,
                          "a cable instead of radio, a switch of its own, fewer recorders; is this "
                          "host or that one overloaded?"});
    }
  }
  return findings;
}

}  // namespace sinew::inspect
