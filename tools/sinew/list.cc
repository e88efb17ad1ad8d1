#include <sinew_idl/status.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/base/types/printable.h"
#include "components/model/report/section.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/recorded_time.h"
#include "components/record/recording/run_import.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/matching.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/peer_checks.h"
#include "tools/inspect/topic_table.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// Characters of a line: the readers of the rig's joint_state then take two lines.
constexpr std::size_t kTableWidth = 128;

struct ListOptions {
  node::Options node;
  std::filesystem::path recording;
  double wait_s = 2.0;
  bool all = false, json = false;
};

std::string Plain(const std::string& dds_topic) {
  return dds_topic.rfind("rt/", 0) == 0 ? dds_topic.substr(3) : dds_topic;  // ROS 2 spelling
}

// Two participants of one name are there twice.
std::vector<std::string> Names(const std::set<std::pair<std::string, std::string>>& participants) {
  std::vector<std::string> names;
  names.reserve(participants.size());
  for (const auto& [name, guid] : participants) names.push_back(name);
  return names;
}

Json DescribeTopics(const std::vector<node::Endpoint>& endpoints,
                    std::vector<std::string>* problems) {
  struct Row {
    std::set<std::string> types;
    std::set<std::pair<std::string, std::string>> writers,
        readers;  // name and GUID of a participant
    std::uint32_t greatest_strength = 0;
    std::string owner;  // of an EXCLUSIVE topic with several writers: the one that is heard
  };
  std::map<std::string, Row> topics;
  for (const node::Endpoint& endpoint : endpoints) {
    Row& row = topics[Plain(endpoint.topic)];
    row.types.insert(endpoint.type_name);
    (endpoint.is_writer ? row.writers : row.readers)
        .emplace(endpoint.participant, node::ParticipantId(endpoint));
    const node::TopicInfo* info = node::FindTopic(Plain(endpoint.topic));
    if (endpoint.is_writer && info != nullptr && node::IsExclusive(info->profile) &&
        endpoint.strength > row.greatest_strength) {
      row.greatest_strength = endpoint.strength;
      row.owner = endpoint.participant;
    }
  }
  Json rows = Json::array();
  for (const auto& [name, row] : topics) {
    rows.push_back({{"name", name},
                    {"types", row.types},
                    {"known", node::FindTopic(name) != nullptr},
                    {"writers", Names(row.writers)},
                    {"owner", row.writers.size() > 1 ? row.owner : ""},
                    {"readers", Names(row.readers)}});
    if (name == node::kJointState.name && row.writers.size() > 1) {
      problems->push_back("several state providers: " + types::Joined(Names(row.writers)) +
                          "; there may be one a domain");
    }
  }
  return rows;
}

// A row for each writer and reader: two writers of one topic are two rows.
Json DescribeEndpoints(const std::vector<node::Endpoint>& endpoints,
                       const std::vector<inspect::Mismatch>& mismatches) {
  std::vector<node::Endpoint> sorted = endpoints;
  std::sort(sorted.begin(), sorted.end(), [](const node::Endpoint& a, const node::Endpoint& b) {
    return std::tie(a.topic, b.is_writer, a.participant, a.guid) <
           std::tie(b.topic, a.is_writer, b.participant, b.guid);
  });
  Json rows = Json::array();
  for (const node::Endpoint& endpoint : sorted) {
    std::set<std::pair<std::string, std::string>> matched;
    for (const node::Endpoint& other : endpoints) {
      if (other.topic == endpoint.topic && other.is_writer != endpoint.is_writer &&
          node::ParticipantId(other) != node::ParticipantId(endpoint)) {
        matched.emplace(other.participant, other.guid);
      }
    }
    Json unmatched = Json::array();
    for (const inspect::Mismatch& mismatch : mismatches) {
      const node::Endpoint& own = endpoint.is_writer ? mismatch.writer : mismatch.reader;
      const node::Endpoint& other = endpoint.is_writer ? mismatch.reader : mismatch.writer;
      if (own.guid != endpoint.guid) continue;
      matched.erase({other.participant, other.guid});
      unmatched.push_back({{"participant", other.participant}, {"why", mismatch.reasons}});
    }
    Json row = {
        {"topic", Plain(endpoint.topic)},      {"role", endpoint.is_writer ? "writer" : "reader"},
        {"participant", endpoint.participant}, {"guid", endpoint.guid},
        {"type", endpoint.type_name},          {"qos", node::DescribeQos(endpoint.qos)},
        {"matched", Names(matched)},           {"unmatched", unmatched}};
    if (endpoint.is_writer && endpoint.qos.exclusive) row["strength"] = endpoint.strength;
    rows.push_back(std::move(row));
  }
  return rows;
}

Json DescribeDomain(const ListOptions& options) {
  node::Node node(options.node);
  auto statuses = node.MakeReader(node::kComponentStatus);
  // A name may be taken twice, so a row is a process.
  std::map<std::tuple<std::string, std::string, std::uint32_t>, msg::ComponentStatus> components;
  const auto end = Clock::now() + std::chrono::duration<double>(options.wait_s);
  while (Clock::now() < end) {
    while (auto status = statuses.TakeNext()) {
      const std::string name = status->name;
      if (name == options.node.name) continue;
      components[{name, status->host, status->process_id}] = *status;
    }
    node.WaitForData(milliseconds(50));
  }

  Json report;
  report["domain"] = options.node.domain_id;
  report["host"] = node::HostName();
  std::vector<std::string> problems = node.Problems();
  report["participants"] = Json::array();
  const std::string own_hash = node::AllTopicsHash();
  std::set<std::string> named;
  for (const auto& [key, status] : components) {
    const std::string& name = std::get<0>(key);
    if (!named.insert(name).second) {
      problems.push_back("several participants are named '" + name + "'; give each its own --name");
    }
    report["participants"].push_back({{"name", name},
                                      {"state", NameOf(status.state)},
                                      {"standby", status.standby},
                                      {"permitted_replay", status.permitted_replay},
                                      {"process_id", status.process_id},
                                      {"host", status.host},
                                      {"version", status.version},
                                      {"idl_hash", status.idl_hash},
                                      {"cycles", status.cycles},
                                      {"stale_inputs", status.stale_inputs},
                                      {"missed_ticks", status.missed_ticks},
                                      {"write_failures", status.write_failures},
                                      {"received_datagrams", status.received_datagrams},
                                      {"refused_datagrams", status.refused_datagrams},
                                      {"resident_MB", status.resident_MB},
                                      {"message", status.message}});
    if (status.idl_hash != own_hash) {
      problems.push_back("'" + name + "' was built with other topics (hash " + status.idl_hash +
                         ", this build " + own_hash + "): rebuild one of them");
    }
    if (status.state == msg::ComponentState::kFault) {
      problems.push_back("'" + name + "' is in fault: " + status.message);
    }
  }

  const std::vector<node::Endpoint> endpoints = node.Endpoints();
  const std::vector<inspect::Mismatch> mismatches = inspect::Mismatches(endpoints);
  for (const node::Endpoint& endpoint : endpoints) {
    if (!endpoint.participant.empty() && named.insert(endpoint.participant).second) {
      report["participants"].push_back({{"name", endpoint.participant}, {"state", "unknown"}});
    }
  }
  report["topics"] = DescribeTopics(endpoints, &problems);
  report["endpoints"] = DescribeEndpoints(endpoints, mismatches);
  for (const inspect::Mismatch& mismatch : mismatches) {
    for (const std::string& reason : mismatch.reasons) {
      problems.push_back("topic '" + Plain(mismatch.writer.topic) + "': '" +
                         mismatch.writer.participant + "' is not heard by '" +
                         mismatch.reader.participant + "': " + reason);
    }
  }
  report["problems"] = problems;
  return report;
}

// The state, and that another participant is heard in its place.
std::string Standing(const Json& row) {
  const std::string state = row["state"];
  return row.value("standby", false) && state == "active" ? "standby" : state;
}

// The message, and that a recording may move the robot.
std::string ShownMessage(const Json& row) {
  std::string message = row.value("message", "");
  const std::string permitted = row.value("permitted_replay", "");
  if (permitted.empty()) return message;
  return (message.empty() ? "" : message + "; ") + "permits the replay of '" + permitted + "'";
}

// Participants of other implementations may have none.
std::string ShownName(const Json& participant) {
  const std::string name = participant.get<std::string>();
  return name.empty() ? "(no name)" : name;
}

std::vector<std::string> ShownNames(const Json& participants) {
  std::vector<std::string> names;
  for (const Json& participant : participants) names.push_back(ShownName(participant));
  return names;
}

inspect::TopicRow RowOfWriter(const Json& endpoint, const std::string& owner) {
  inspect::TopicRow row;
  row.topic = endpoint["topic"].get<std::string>();
  row.type = inspect::DisplayedType(row.topic, endpoint["type"].get<std::string>());
  row.writer = ShownName(endpoint["participant"]);
  if (!owner.empty() && row.writer == owner) row.writer += " (heard)";
  row.qos = endpoint["qos"].get<std::string>();
  row.readers = ShownNames(endpoint["matched"]);
  for (const Json& reader : endpoint["unmatched"]) {
    row.unmatched.push_back(
        {ShownName(reader["participant"]), reader["why"].get<std::vector<std::string>>()});
  }
  return row;
}

inspect::TopicRow RowWithoutWriter(const Json& topic) {
  inspect::TopicRow row;
  row.topic = topic["name"].get<std::string>();
  std::vector<std::string> types;
  for (const Json& type : topic["types"]) {
    types.push_back(inspect::DisplayedType(row.topic, type.get<std::string>()));
  }
  row.type = types::Joined(types);
  row.writer = row.qos = "-";
  row.readers = ShownNames(topic["readers"]);
  return row;
}

// Topics of every participant, which are rows only with --all.
bool IsHidden(const std::string& topic) {
  static const std::set<std::string> kHidden = {"component_snapshot", "component_status", "log",
                                                "recording_progress", "snapshot_request"};
  return kHidden.contains(topic);
}

void PrintHidden(const std::vector<std::string>& hidden, std::size_t width) {
  if (hidden.empty()) return;
  Print("%s\n", ("not shown without --all: " + types::Joined(hidden)).substr(0, width).c_str());
}

// A row for each writer; a topic without writers is a row, too.
void PrintTopics(const Json& report, bool all) {
  std::vector<inspect::TopicRow> rows;
  std::vector<std::string> hidden;
  for (const Json& topic : report["topics"]) {
    if (!all && IsHidden(topic["name"])) {
      hidden.push_back(topic["name"]);
      continue;
    }
    const std::string owner = topic["owner"].get<std::string>();
    if (topic["writers"].empty()) rows.push_back(RowWithoutWriter(topic));
    for (const Json& endpoint : report["endpoints"]) {
      if (endpoint["topic"] != topic["name"] || endpoint["role"] != "writer") continue;
      rows.push_back(RowOfWriter(endpoint, owner));
    }
  }
  if (!rows.empty()) Print("\n%s", inspect::FormatTopicTable(rows, kTableWidth).c_str());
  PrintHidden(hidden, kTableWidth);
}

// A value of a participant's row, as text; "-" for one that sends no component_status.
std::string Cell(const Json& row, const char* key) {
  return row.contains(key) ? types::JsonText(row[key]) : "-";
}

// own_host: where this command runs.
void PrintParticipants(const Json& rows, const std::string& own_host) {
  if (rows.empty()) return;
  std::size_t name_width = std::string_view("participant").size();
  std::set<std::string> hosts = {own_host};
  for (const Json& row : rows) {
    name_width = std::max(name_width, row["name"].get<std::string>().size());
    if (row.contains("host")) hosts.insert(row["host"].get<std::string>());
  }
  // Hosts, and the ticks that were lost on the way, are columns only where there are several.
  std::size_t host_width = 0;
  if (hosts.size() > 1) {
    host_width = std::string_view("host").size() + 2;
    for (const std::string& host : hosts) host_width = std::max(host_width, host.size() + 2);
  }
  const auto print = [&](const std::string& name, const std::string& host, const std::string& state,
                         const std::array<std::string, 4>& numbers, const std::string& missed,
                         const std::string& message) {
    std::string line = name + std::string(name_width + 2 - name.size(), ' ');
    if (host_width > 0) line += host + std::string(host_width - host.size(), ' ');
    char columns[80];
    std::snprintf(columns, sizeof(columns), "%-10s %8s %10s %8s %6s", state.c_str(),
                  numbers[0].c_str(), numbers[1].c_str(), numbers[2].c_str(), numbers[3].c_str());
    line += columns;
    if (host_width > 0) {
      std::snprintf(columns, sizeof(columns), " %8s", missed.c_str());
      line += columns;
    }
    if (!message.empty()) line += "  " + message;
    Print("%s\n", line.c_str());
  };
  Print("\n");
  print("participant", "host", "state", {"pid", "cycles", "stale", "MB"}, "missed", "message");
  for (const Json& row : rows) {
    const std::string memory =
        row.contains("resident_MB")
            ? std::to_string(static_cast<int>(row["resident_MB"].get<double>()))
            : "-";
    print(row["name"].get<std::string>(), row.value("host", "-"), Standing(row),
          {Cell(row, "process_id"), Cell(row, "cycles"), Cell(row, "stale_inputs"), memory},
          Cell(row, "missed_ticks"), ShownMessage(row));
  }
}

// A report for the terminal: its texts are names and messages of others, each in its own line.
Json Printable(Json report) {
  if (report.is_string()) return types::Printable(report.get<std::string>());
  if (report.is_structured()) {
    for (Json& part : report) part = Printable(std::move(part));
  }
  return report;
}

void PrintDomain(const Json& report, bool all) {
  std::cout << "domain " << report["domain"] << ": " << report["participants"].size()
            << " participants, " << report["topics"].size() << " topics"
            << (report["participants"].empty() ? isolation::OthersIn(report["domain"]) : "")
            << '\n';
  std::cout.flush();
  PrintParticipants(report["participants"], report["host"].get<std::string>());
  PrintTopics(report, all);
  std::cout << std::flush;
  if (!report["problems"].empty()) std::cout << '\n';
  for (const Json& problem : report["problems"]) {
    std::cout << "problem: " << problem.get<std::string>() << '\n';
  }
}

Json DescribeRecording(const std::filesystem::path& path) {
  recording::FileSource source(path);
  try {
    const recording::McapReader reader(source);
    const recording::McapStatistics& statistics = reader.statistics();
    const auto span = recording::RecordedTime(reader).span().value_or(
        recording::RecordedTime::Span{statistics.start_time_ns, statistics.end_time_ns});
    if (const recording::LeftOut foreign = recording::NotReadableTopics(reader); !foreign.empty()) {
      std::cerr << recording::LeftOutText(path.string(), foreign) << '\n';
    }
    Json report;
    report["file"] = path.string();
    report["bytes"] = source.size();
    report["messages"] = statistics.message_count;
    report["chunks"] = statistics.chunk_count;
    report["duration_s"] = recording::SecondsFromStamp(span.end_ns - span.start_ns);
    if (reader.recovery()) {
      report["cut_off"] = {{"good_bytes", reader.recovery()->good_bytes},
                           {"lost_bytes", reader.recovery()->lost_bytes},
                           {"reason", reader.recovery()->reason}};
    }
    report["topics"] = Json::array();
    for (const auto& [id, channel] : reader.channels()) {
      const recording::McapSchema* schema = reader.SchemaOf(channel);
      const auto count = statistics.channel_message_counts.find(id);
      const auto hash = channel.metadata.find("idl_hash");
      const auto writer = channel.metadata.find("participant");
      report["topics"].push_back(
          {{"name", channel.topic},
           {"type", schema == nullptr ? "" : schema->name},
           {"idl_hash", hash == channel.metadata.end() ? "" : hash->second},
           {"writer", writer == channel.metadata.end() ? "" : writer->second},
           {"messages", count == statistics.channel_message_counts.end() ? 0 : count->second}});
    }
    std::sort(report["topics"].begin(), report["topics"].end(), [](const Json& a, const Json& b) {
      return std::tie(a["name"], a["writer"]) < std::tie(b["name"], b["writer"]);
    });
    report["metadata"] = Json::array();
    for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
      Json entry = {{"name", metadata.name}};
      for (const auto& [key, value] : metadata.values) entry[key] = value;
      report["metadata"].push_back(entry);
    }
    report["attachments"] = Json::array();
    for (const recording::McapAttachment& attachment : reader.ReadAttachments()) {
      report["attachments"].push_back(
          {{"name", attachment.name}, {"bytes", attachment.data.size()}});
    }
    return report;
  } catch (const recording::McapError& error) {
    throw UsageError(path.string() + ": " + error.what());
  }
}

void PrintCutOff(const Json& report) {
  if (!report.contains("cut_off")) return;
  std::cout << "cut off: " << report["cut_off"]["good_bytes"] << " bytes are whole, "
            << report["cut_off"]["lost_bytes"] << " are lost ("
            << report["cut_off"]["reason"].get<std::string>() << ")\n";
}

// Metadata that are shown without --all.
bool IsInSummary(const std::string& name, const std::string& key, const std::string& value) {
  static const std::set<std::string> kRun = {"deployment", "domain_id", "host",   "mode",
                                             "seed",       "started",   "version"};
  if (name == "sinew.recording") return kRun.contains(key);
  if (name == "sinew.losses") return value != "0";
  return name != "sinew.files";
}

// About twenty lines, as wide as the terminal: a row for each topic of the robot.
void PrintSummary(const Json& listed) {
  const std::size_t width = ::isatty(STDOUT_FILENO) == 1
                                ? static_cast<std::size_t>(SizeOfTerminal(STDOUT_FILENO).columns)
                                : std::string::npos;
  const auto print = [width](const std::string& line) {
    Print("%s\n", line.substr(0, width).c_str());
  };
  Print("%s: %s messages, %.1f MB, %.1f s\n", listed["file"].get<std::string>().c_str(),
        types::JsonText(listed["messages"]).c_str(), 1e-6 * listed["bytes"].get<double>(),
        listed["duration_s"].get<double>());
  PrintCutOff(listed);
  std::set<std::string> lines;  // equal ones once
  for (const Json& metadata : listed["metadata"]) {
    const std::string name = metadata["name"].get<std::string>();
    std::string line;
    for (const auto& [key, value] : metadata.items()) {
      const std::string text = value.get<std::string>();
      if (key != "name" && IsInSummary(name, key, text)) line += " " + key + "=" + text;
    }
    if (!line.empty() && lines.insert(name + line).second) print(name + ":" + line);
  }
  std::vector<std::string> attached, hidden;
  for (const Json& one : listed["attachments"]) attached.push_back(one["name"]);
  if (!attached.empty()) print("attachments: " + types::Joined(attached));
  struct Row {
    std::uint64_t messages = 0;
    std::vector<std::string> writers;
    std::string type;
  };
  std::map<std::string, Row> rows;
  for (const Json& channel : listed["topics"]) {
    Row& row = rows[channel["name"]];
    row.messages += channel["messages"].get<std::uint64_t>();
    row.writers.push_back(channel["writer"]);
    const std::string type = channel["type"].get<std::string>();
    row.type = type.substr(type.rfind(':') + 1);
  }
  Print("\n%-20s %10s  %-18s %s\n", "topic", "messages", "type", "writers");
  for (const auto& [name, row] : rows) {
    if (IsHidden(name)) {
      hidden.push_back(name);
      continue;
    }
    print(report::Text("%-20s %10llu  %-18s ", name.c_str(),
                       static_cast<unsigned long long>(row.messages), row.type.c_str()) +
          types::Joined(row.writers));
  }
  PrintHidden(hidden, width);
}

// Everything.
void PrintRecording(const Json& report) {
  std::cout << report["file"].get<std::string>() << ": " << report["messages"] << " messages, "
            << report["bytes"] << " bytes, " << report["duration_s"] << " s\n";
  PrintCutOff(report);
  for (const Json& metadata : report["metadata"]) {
    std::cout << metadata["name"].get<std::string>() << ":";
    for (const auto& [key, value] : metadata.items()) {
      if (key != "name") std::cout << ' ' << key << '=' << value.get<std::string>();
    }
    std::cout << '\n';
  }
  for (const Json& attachment : report["attachments"]) {
    std::cout << "attachment: " << attachment["name"].get<std::string>() << ", "
              << attachment["bytes"] << " bytes\n";
  }
  Print("\n%-20s %-16s %10s  %-10s %s\n", "topic", "writer", "messages", "hash", "type");
  for (const Json& row : report["topics"]) {
    Print("%-20s %-16s %10s  %-10s %s\n", row["name"].get<std::string>().c_str(),
          row["writer"].get<std::string>().c_str(), types::JsonText(row["messages"]).c_str(),
          row["idl_hash"].get<std::string>().c_str(), row["type"].get<std::string>().c_str());
  }
}

}  // namespace

void AddListCommand(CLI::App& app) {
  auto options = std::make_shared<ListOptions>();
  CLI::App* command = app.add_subcommand(
      "list", "Participants, topics and problems of a domain; or the contents of a recording");
  AddNodeOptions(*command, &options->node);
  command->add_option("recording", options->recording,
                      "Describe this MCAP file instead of a domain");
  command->add_option("--wait", options->wait_s, "Seconds to listen")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag(
      "--all", options->all,
      "With snapshots, status and logs; of a recording all metadata and writers, too");
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "A row for each writer with type, QoS and the readers that hear it; below it those that do "
      "not "
      "match, and why.\n"
      "--json has a row for each reader as well. Problems are builds with other topic types, QoS "
      "that "
      "does not match,\n"
      "faults, two state providers; with any, the exit code is 1.\n\nExamples:\n"
      "  sinew list --domain 0\n  sinew list run.mcap\n  sinew list run.mcap --all");
  command->callback([options] {
    if (!options->recording.empty()) {
      const Json report = DescribeRecording(options->recording);
      if (options->json) {
        std::cout << types::JsonText(report) << '\n';
      } else if (options->all) {
        PrintRecording(Printable(report));
      } else {
        PrintSummary(Printable(report));
      }
      return;
    }
    spdlog::set_level(spdlog::level::off);  // problems are part of the report
    const Json report = DescribeDomain(*options);
    if (options->json) {
      std::cout << types::JsonText(report) << '\n';
    } else {
      PrintDomain(Printable(report), options->all);
    }
    if (!report["problems"].empty()) throw CLI::RuntimeError(1);
  });
}

}  // namespace sinew::tools
