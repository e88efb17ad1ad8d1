#include <sinew_idl/status.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/json_text.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/interfaces.h"
#include "components/topics/node/node.h"
#include "components/topics/node/realtime.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/can_check.h"
#include "tools/inspect/findings.h"
#include "tools/inspect/host_checks.h"
#include "tools/inspect/peer_checks.h"
#include "tools/inspect/run_tool.h"
#include "tools/inspect/shared_memory.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"

namespace sinew::tools {

namespace {

using inspect::Finding;
using inspect::Severity;

struct DoctorOptions {
  node::Options node;
  std::filesystem::path root = "/";
  std::filesystem::path recordings = ".";
  double wait_s = 3.0;  // two announcements of component_status and discovery
  double recording_bytes_s = 1.2e6;
  inspect::CanSettings can;
  bool offline = false;
  bool clean = false;
  bool strict = false;
  bool json = false;
};

void Append(std::vector<Finding>* all, const std::vector<Finding>& more) {
  all->insert(all->end(), more.begin(), more.end());
}

// The highest priority that --realtime asks for.
int HighestPriority() {
  int highest = 0;
  for (const node::PriorityRule& rule : node::PriorityRules()) {
    highest = std::max(highest, rule.priority);
  }
  return highest;
}

std::vector<Finding> CheckCanInterfaces(const inspect::ToolResult& ip,
                                        const inspect::CanSettings& settings) {
  if (!ip.found) {
    return {{"can", Severity::kNote, "the program 'ip' was not found", "apt-get install iproute2"}};
  }
  try {
    return inspect::CheckCan(ip.output, settings);
  } catch (const std::invalid_argument& error) {
    return {{"can", Severity::kNote, error.what(), "ip -details link show"}};
  }
}

// Messages heard in a domain: DDS threads add, the command reads at the end.
class Heard {
 public:
  void AddStatus(const node::RawSample& sample) {
    msg::ComponentStatus status;
    if (!node::Decode(sample.payload, &status)) return;
    const std::lock_guard lock(mutex_);
    // component_status is latched: the first one of a writer may be old.
    const auto [at, from_history] = participants_.try_emplace(ParticipantOf(sample.writer));
    const std::string host = status.host;
    samples_.push_back({host, sample.source_stamp_ns, sample.reception_stamp_ns, from_history});
    Participant& participant = at->second;
    if (participant.session != status.header.session_id) {
      participant = {status.name, host, status.header.session_id, status.header.tick,
                     status.missed_ticks};
    }
    participant.ticks = status.header.tick - participant.first_tick;
    participant.missed = status.missed_ticks - participant.first_missed;
    participant.received = status.received_datagrams;
    participant.refused = status.refused_datagrams;
  }

  // A message of every cycle.
  void AddCycle(const node::RawSample& sample) {
    const std::lock_guard lock(mutex_);
    Cycles& cycles =
        cycles_.try_emplace(sample.writer, Cycles{sample.topic, sample.sequence}).first->second;
    cycles.last = std::max(cycles.last, sample.sequence);
    ++cycles.heard;
  }

  std::vector<Finding> Findings() const {
    const std::lock_guard lock(mutex_);
    const std::string own_host = node::HostName();
    std::vector<Finding> findings = inspect::CheckClocks(samples_, own_host);
    std::vector<inspect::Loss> losses;
    std::string provider_host;
    for (const auto& [writer, cycles] : cycles_) {
      const auto at = participants_.find(ParticipantOf(writer));
      if (at == participants_.end()) continue;
      if (cycles.topic == node::kJointState.name) provider_host = at->second.host;
      if (at->second.host == own_host) continue;
      const std::uint64_t sent = cycles.last - cycles.first + 1;
      losses.push_back({cycles.topic + " of host '" + at->second.host + "' on its way here", sent,
                        sent - std::min(sent, cycles.heard)});
    }
    for (const auto& [id, participant] : participants_) {
      if (participant.refused > 0) {
        findings.push_back({"datagrams", Severity::kWarning,
                            "'" + participant.name + "' of host '" + participant.host +
                                "' refused " + std::to_string(participant.refused) + " of " +
                                std::to_string(participant.received) + " datagrams",
                            "its log: senders and reasons (no key, or no RTPS that is read here)"});
      }
      if (provider_host.empty() || participant.host == provider_host) continue;
      losses.push_back({"ticks of host '" + provider_host + "' at '" + participant.name +
                            "' of host '" + participant.host + "'",
                        participant.ticks, participant.missed});
    }
    const bool elsewhere =
        std::any_of(participants_.begin(), participants_.end(),
                    [&own_host](const auto& each) { return each.second.host != own_host; });
    if (losses.empty() && elsewhere) {
      findings.push_back({"losses", Severity::kNote,
                          "no message of every cycle came from another host, no loss was counted",
                          "a longer --wait: on a lossy network matching takes seconds"});
    }
    Append(&findings, inspect::CheckLosses(losses));
    return findings;
  }

 private:
  using ParticipantId = std::array<std::uint8_t, 12>;  // the GUID's first part
  struct Participant {
    std::string name, host;
    std::uint64_t session = 0;
    std::uint64_t first_tick = 0, first_missed = 0;
    std::uint64_t ticks = 0, missed = 0;      // since the first message
    std::uint64_t received = 0, refused = 0;  // datagrams
  };
  struct Cycles {
    std::string topic;
    std::uint64_t first = 0, last = 0, heard = 0;  // numbers of DDS, without gaps
  };

  static ParticipantId ParticipantOf(const node::WriterId& writer) {
    ParticipantId id{};
    std::copy_n(writer.begin(), id.size(), id.begin());
    return id;
  }

  mutable std::mutex mutex_;
  std::vector<inspect::ClockSample> samples_;
  std::map<ParticipantId, Participant> participants_;
  std::map<node::WriterId, Cycles> cycles_;
};

inspect::Openness OpennessOf(const DoctorOptions& options, bool has_security,
                             const std::string& ip_json) {
  const std::vector<std::string> tunnels = inspect::WireGuardIn(ip_json);
  std::vector<node::internal::InterfaceAddress> addresses = node::internal::RunningInterfaces();
  std::erase_if(addresses, [&tunnels](const auto& entry) {
    return std::find(tunnels.begin(), tunnels.end(), entry.interface) == tunnels.end();
  });
  const auto holder = isolation::Inside();
  return {options.node.interfaces, has_security || !options.node.key_path.empty(), addresses,
          holder ? holder->deployment : ""};
}

// Listens in the domain.
std::vector<Finding> CheckDomain(const DoctorOptions& options, const std::string& ip_json) {
  const auto heard = std::make_shared<Heard>();
  node::Node node(options.node);
  node.ReadRaw(*node::FindTopic(node::kComponentStatus.name),
               [heard](node::RawSample&& sample) { heard->AddStatus(sample); });
  for (const std::string_view topic : {node::kJointState.name, node::kJointCommand.name}) {
    node.ReadRaw(*node::FindTopic(topic),
                 [heard](node::RawSample&& sample) { heard->AddCycle(sample); });
  }
  using DoctorClock = std::chrono::steady_clock;
  const auto end = DoctorClock::now() + std::chrono::duration<double>(options.wait_s);
  while (DoctorClock::now() < end) node.WaitForData(std::chrono::milliseconds(50));
  const std::vector<node::Endpoint> endpoints = node.Endpoints();
  std::vector<Finding> findings = {
      inspect::CheckOpenness(OpennessOf(options, node.has_security(), ip_json), endpoints)};
  if (endpoints.empty()) {
    findings.push_back({"participants", Severity::kNote,
                        "none in domain " + std::to_string(options.node.domain_id) +
                            isolation::OthersIn(options.node.domain_id),
                        "start the deployment first, or --domain, --interface of another one; "
                        "one with keys is heard with --key or --qos alone"});
    return findings;
  }
  Append(&findings, inspect::CheckPeers(endpoints, node.Problems()));
  Append(&findings, heard->Findings());
  return findings;
}

std::vector<Finding> Examine(const DoctorOptions& options) {
  std::vector<Finding> findings;
  // Before this process becomes a participant itself.
  if (options.clean) {
    findings.push_back(inspect::CleanSharedMemory(options.root, ::getpid()));
  } else {
    findings.push_back(
        inspect::CheckSharedMemory(inspect::ReadSharedMemory(options.root, ::getpid())));
  }
  const std::filesystem::path shared = options.root / "dev/shm";
  if (std::filesystem::exists(shared)) {
    findings.push_back(inspect::CheckSharedMemorySpace(inspect::ReadDiskSpace(shared)));
  }
  Append(&findings, inspect::CheckRealtimeLimits(options.root, HighestPriority()));
  findings.push_back(inspect::CheckCpuGovernor(options.root));
  findings.push_back(inspect::CheckDiskSpace(inspect::ReadDiskSpace(options.recordings),
                                             options.recording_bytes_s));
  const inspect::ToolResult ip =
      inspect::RunTool("ip", {"-json", "-details", "-statistics", "link", "show"});
  Append(&findings, CheckCanInterfaces(ip, options.can));
  if (!options.offline) Append(&findings, CheckDomain(options, ip.output));
  return findings;
}

}  // namespace

void AddDoctorCommand(CLI::App& app) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      app.add_subcommand("doctor", "Check host, shared memory, CAN and participants, with advice");
  AddNodeOptions(*command, &options->node);
  command->add_option("--wait", options->wait_s, "Seconds to listen in the domain")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag("--offline", options->offline, "Only this host, without joining the domain");
  command->add_flag("--clean", options->clean,
                    "Remove the files of Fast DDS in /dev/shm; never while a participant lives");
  command->add_option("--recordings", options->recordings, "Folder that recordings go to")
      ->capture_default_str();
  command
      ->add_option("--recording-rate", options->recording_bytes_s,
                   "Bytes a second of a recording; the default is above the rig's with all "
                   "topics at 240 Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--bitrate", options->can.bitrate_bit_s, "Bits per second of the CAN buses")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--root", options->root,
                   "Folder that stands for / in the checks of files (dev/shm, proc, sys)")
      ->capture_default_str();
  command->add_flag("--strict", options->strict, "Exit code 1 for warnings, too");
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Severities: ok, note (not checked, or it matters only in some uses), warning, fault. Exit "
      "code 1 with\n"
      "any fault.\n\nExamples:\n"
      "  sinew doctor --domain 0\n"
      "  sinew doctor --offline --recordings /var/recordings --strict\n"
      "  sinew doctor --clean --offline");
  command->callback([options] {
    spdlog::set_level(spdlog::level::off);  // problems are part of the report
    const std::vector<Finding> findings = Examine(*options);
    if (options->json) {
      const int code = inspect::ExitCode(findings, options->strict);
      std::cout << types::JsonText(nlohmann::ordered_json{
                       {"healthy", code == 0}, {"findings", inspect::FindingsJson(findings)}})
                << '\n';
    } else {
      std::cout << inspect::FormatFindings(findings);
    }
    if (inspect::ExitCode(findings, options->strict) != 0) throw CLI::RuntimeError(1);
  });
}

}  // namespace sinew::tools
