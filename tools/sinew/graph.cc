#include "tools/inspect/graph.h"

#include <sinew_idl/status.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/run_tool.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/recordings.h"
#include "tools/sinew/span_messages.h"

namespace sinew::tools {

namespace {

struct GraphOptions {
  node::Options node;
  RecordedSpan recorded;
  std::filesystem::path out;
  double wait_s = 2.0;
  bool all = false;
};

inspect::Graph ListenForGraph(const GraphOptions& options) {
  using GraphClock = std::chrono::steady_clock;
  node::Node node(options.node);
  auto statuses = node.MakeReader(node::kComponentStatus);
  std::map<node::WriterId, std::string> hosts;
  const auto end = GraphClock::now() + std::chrono::duration<double>(options.wait_s);
  while (GraphClock::now() < end) {
    node.WaitForData(std::chrono::milliseconds(50));
    while (const auto status = statuses.TakeNext()) {
      hosts[statuses.writer()] = status->host;
    }
  }
  std::map<std::string, std::string> by_participant;
  for (const auto& [writer, host] : hosts) {
    node::Endpoint endpoint;
    if (const auto name = node.NameOf(writer)) endpoint.guid = name->guid;
    by_participant[node::ParticipantId(endpoint)] = host;
  }
  return inspect::GraphOfDomain(node.Endpoints(), options.all, by_participant);
}

// Channels with a message in the span.
std::set<recording::ChannelId> HeardIn(const recording::McapReader& reader,
                                       const RecordedSpan& span) {
  std::set<recording::ChannelId> heard;
  SpanMessages messages(reader, {}, span);
  recording::McapMessage message;
  while (messages.Next(&message)) heard.insert(message.channel_id);
  return heard;
}

inspect::Graph GraphFromFile(const std::string& file, const GraphOptions& options) {
  recording::FileSource source(file);
  try {
    const recording::McapReader reader(source);
    std::vector<inspect::RecordedWriter> writers;
    std::map<std::string, std::string> kinds;  // by name
    recording::LeftOut foreign;
    const bool whole = options.recorded.IsWhole();
    const std::set<recording::ChannelId> heard =
        whole ? std::set<recording::ChannelId>() : HeardIn(reader, options.recorded);
    for (const auto& [id, channel] : reader.channels()) {
      const auto writer = channel.metadata.find("participant");
      if (whole || heard.contains(id)) {
        writers.push_back({channel.topic, writer == channel.metadata.end() ? "" : writer->second});
      }
      if (!recording::IsReadable(reader, channel, &foreign)) continue;
      if (channel.topic != node::kComponentStatus.name) continue;
      const recording::MessageType type = recording::MessageTypeOf(reader, channel);
      if (!recording::HasField(*type.type, "name") ||
          !recording::HasField(*type.type, "component_kind")) {
        foreign.emplace(channel.topic, "topic 'component_status' has no name or no component_kind");
        continue;
      }
      const recording::CdrField name(*type.type, "name"), kind(*type.type, "component_kind");
      recording::MessageFilter filter;
      filter.topics = std::set<std::string>{channel.topic};
      recording::McapMessages messages = reader.Messages(filter);
      recording::McapMessage message;
      while (messages.Next(&message)) {
        if (message.channel_id == id) kinds[name.AsText(message.data)] = kind.AsText(message.data);
      }
    }
    if (!foreign.empty()) std::cerr << recording::LeftOutText(file, foreign) << '\n';
    std::vector<inspect::RecordedParticipant> participants;
    participants.reserve(kinds.size());
    for (const auto& [name, kind] : kinds) {
      const bool writes =
          std::any_of(writers.begin(), writers.end(),
                      [&wanted = name](const auto& w) { return w.participant == wanted; });
      if (whole || writes) participants.push_back({name, kind});
    }
    return inspect::GraphOfRecording(writers, participants, options.all);
  } catch (const recording::McapError& error) {
    throw UsageError(file + ": " + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(file + ": component_status: " + error.what());
  }
}

// As the ending of the file's name asks for.
std::string Render(const std::string& dot, const std::filesystem::path& out) {
  const std::string ending = out.extension().string();
  if (ending == ".dot" || ending == ".gv") return dot;
  if (ending != ".svg" && ending != ".png" && ending != ".pdf") {
    throw UsageError("--out: '" + out.string() +
                     "', expected a name that ends in .dot, .gv, .svg, "
                     ".png or .pdf");
  }
  return inspect::OutputOf("dot", "graphviz", {"-T" + ending.substr(1)}, dot);
}

}  // namespace

void AddGraphCommand(CLI::App& app) {
  auto options = std::make_shared<GraphOptions>();
  CLI::App* command =
      app.add_subcommand("graph", "A picture of who speaks to whom, live or from a recording");
  AddNodeOptions(*command, &options->node);
  AddRecordings(*command, "", &options->recorded.files, "Recording to read instead of a domain");
  AddSpan(*command, &options->recorded, "sinew graph FILE.mcap");
  command->add_option("--out", options->out,
                      "File to write: .dot, .gv, .svg, .png or .pdf; by default the graph's text "
                      "in the language of Graphviz on standard output");
  command->add_option("--wait", options->wait_s, "Seconds to listen")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag("--all", options->all, "With component_status, log and recording_progress");
  command->footer(
      "Boxes are participants, ellipses topics. Red: a reader that no writer matches (sinew list "
      "says why);\n"
      "grey: a topic that nobody writes now.\n"
      "Dashed, of a recording: by the table of topics, since a recording does not contain who "
      "read.\n\nExamples:\n"
      "  sinew graph --out rig.svg\n"
      "  sinew graph run.mcap --out run.png\n"
      "  sinew graph | dot -Tx11");
  command->callback([options] {
    options->recorded.Check();
    const std::string file = OnlyOne(options->recorded.files);
    const inspect::Graph graph =
        file.empty() ? ListenForGraph(*options) : GraphFromFile(file, *options);
    const std::string title = file.empty() ? "domain " + std::to_string(options->node.domain_id)
                                           : std::filesystem::path(file).filename().string();
    const std::string dot = inspect::DotText(graph, title);
    if (graph.participants.empty() && graph.links.empty()) {
      std::cerr << "sinew graph: " << title << ": no participant\n";
      throw CLI::RuntimeError(1);
    }
    if (options->out.empty()) {
      std::cout << dot;
      return;
    }
    config::WriteFileAtomically(options->out, Render(dot, options->out));
  });
}

}  // namespace sinew::tools
