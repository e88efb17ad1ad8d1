#include "tools/inspect/graph.h"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "components/topics/node/matching.h"
#include "components/topics/node/topic_parties.h"

namespace sinew::inspect {

namespace {

// Topics that every participant writes or only a recorder: they hide the rest of a picture.
constexpr std::array<std::string_view, 3> kOfAll = {"component_status", "log",
                                                    "recording_progress"};

bool IsShown(std::string_view topic, bool all) {
  return all || std::find(kOfAll.begin(), kOfAll.end(), topic) == kOfAll.end();
}

std::string PlainTopic(const std::string& topic) {
  return topic.rfind("rt/", 0) == 0 ? topic.substr(3) : topic;  // ROS 2 spelling
}

// In double quotes of the dot language.
std::string DotQuoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

// Whether a party of the table stands for a kind of participant.
bool IsParty(std::string_view party, const std::string& kind) {
  if (party == "all" || party == kind) return true;
  const bool provider = kind == "world" || kind == "surrogate" || kind == "can_bridge";
  return provider && party.starts_with("state provider");
}

bool Writes(const Graph& graph, const std::string& participant, const std::string& topic) {
  return std::any_of(graph.links.begin(), graph.links.end(), [&](const GraphLink& link) {
    return link.writes && link.participant == participant && link.topic == topic;
  });
}

void AddLink(Graph* graph, const GraphLink& link) {
  const bool there =
      std::any_of(graph->links.begin(), graph->links.end(), [&](const GraphLink& other) {
        return other.participant == link.participant && other.topic == link.topic &&
               other.writes == link.writes;
      });
  if (!there) graph->links.push_back(link);
}

bool IsRecorder(const RecordedParticipant& participant) {
  return participant.kind == "logger" || participant.kind == "record";
}

}  // namespace

Graph GraphOfDomain(const std::vector<node::Endpoint>& endpoints, bool all,
                    const std::map<std::string, std::string>& hosts) {
  Graph graph;
  std::set<std::string> different;
  for (const auto& [participant, host] : hosts) different.insert(host);
  // Names by participant, in the order of their GUIDs: the second of a name is "name (2)".
  std::map<std::string, std::string> names;
  std::map<std::string, int> taken;
  for (const node::Endpoint& endpoint : endpoints) {
    const std::string id = node::ParticipantId(endpoint);
    const auto [at, is_new] = names.try_emplace(id, endpoint.participant);
    if (!is_new) continue;
    if (at->second.empty()) at->second = id;
    const int count = ++taken[at->second];
    if (count > 1) at->second += " (" + std::to_string(count) + ")";
    graph.participants.push_back(at->second);
    const auto host = hosts.find(id);
    if (different.size() > 1 && host != hosts.end()) graph.hosts[at->second] = host->second;
  }
  std::set<std::string> unwritten;
  for (const node::Endpoint& endpoint : endpoints) {
    const std::string topic = PlainTopic(endpoint.topic);
    if (!IsShown(topic, all)) continue;
    GraphLink link{names.at(node::ParticipantId(endpoint)), topic, endpoint.is_writer, false,
                   false};
    if (!endpoint.is_writer) {
      bool written_here = false, written_elsewhere = false, matched = false;
      for (const node::Endpoint& writer : endpoints) {
        if (!writer.is_writer || writer.topic != endpoint.topic) continue;
        if (names.at(node::ParticipantId(writer)) == link.participant) {
          written_here = true;
          continue;
        }
        written_elsewhere = true;
        matched = matched || node::WhyNotMatched(writer, endpoint).empty();
      }
      if (written_here && !written_elsewhere) continue;
      link.unmatched = written_elsewhere && !matched;
      if (!written_elsewhere) unwritten.insert(topic);
    }
    AddLink(&graph, link);
  }
  graph.unwritten.assign(unwritten.begin(), unwritten.end());
  return graph;
}

Graph GraphOfRecording(const std::vector<RecordedWriter>& writers,
                       const std::vector<RecordedParticipant>& participants, bool all) {
  Graph graph;
  for (const RecordedParticipant& participant : participants) {
    if (all || !IsRecorder(participant)) graph.participants.push_back(participant.name);
  }
  for (const RecordedWriter& writer : writers) {
    if (!IsShown(writer.topic, all)) continue;
    if (!writer.participant.empty()) {
      if (std::find(graph.participants.begin(), graph.participants.end(), writer.participant) ==
          graph.participants.end()) {
        graph.participants.push_back(writer.participant);
      }
      AddLink(&graph, {writer.participant, writer.topic, true, false, false});
    }
    for (const node::TopicParty& party : node::kTopicParties) {
      if (party.topic != writer.topic) continue;
      const bool writes = party.access == node::Access::kWrites;
      if (writes ? !writer.participant.empty() : !party.always) continue;
      for (const RecordedParticipant& participant : participants) {
        if (IsRecorder(participant) || !IsParty(party.party, participant.kind)) continue;
        if (!writes && Writes(graph, participant.name, writer.topic)) continue;
        AddLink(&graph, {participant.name, writer.topic, writes, true, false});
      }
    }
  }
  return graph;
}

std::string DotText(const Graph& graph, const std::string& title) {
  std::string out = "digraph sinew {\n  rankdir=LR;\n  label=" + DotQuoted(title) +
                    ";\n  labelloc=t;\n  fontname=\"DejaVu Sans\";\n"
                    "  node [fontname=\"DejaVu Sans\", fontsize=11];\n"
                    "  edge [color=\"#5f6b76\"];\n";
  for (const std::string& participant : graph.participants) {
    const auto host = graph.hosts.find(participant);
    const std::string label =
        participant + (host == graph.hosts.end() ? "" : " on " + host->second);
    out += "  " + DotQuoted("p:" + participant) + " [label=" + DotQuoted(label) +
           ", shape=box, style=filled, fillcolor=\"#dcecf1\"];\n";
  }
  std::set<std::string> topics;
  for (const GraphLink& link : graph.links) topics.insert(link.topic);
  const auto is_unwritten = [&graph](const std::string& topic) {
    return std::find(graph.unwritten.begin(), graph.unwritten.end(), topic) !=
           graph.unwritten.end();
  };
  for (const std::string& topic : topics) {
    out += "  " + DotQuoted("t:" + topic) + " [label=" + DotQuoted(topic) + ", shape=ellipse" +
           (is_unwritten(topic) ? ", color=\"#aab4bc\", fontcolor=\"#7b8791\"" : "") + "];\n";
  }
  std::vector<GraphLink> links = graph.links;
  std::sort(links.begin(), links.end(), [](const GraphLink& a, const GraphLink& b) {
    return std::tie(a.topic, b.writes, a.participant) < std::tie(b.topic, a.writes, b.participant);
  });
  for (const GraphLink& link : links) {
    const std::string participant = DotQuoted("p:" + link.participant);
    const std::string topic = DotQuoted("t:" + link.topic);
    out += "  " + (link.writes ? participant + " -> " + topic : topic + " -> " + participant);
    if (link.unmatched) {
      out += " [color=\"#b5402a\", style=dashed, label=\"no match\", fontcolor=\"#b5402a\"]";
    } else if (link.inferred) {
      out += " [style=dashed]";
    } else if (is_unwritten(link.topic)) {
      out += " [color=\"#c8d0d6\"]";
    }
    out += ";\n";
  }
  return out + "}\n";
}

}  // namespace sinew::inspect
