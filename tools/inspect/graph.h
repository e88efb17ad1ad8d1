// Graph of participants (boxes) and the topics (ellipses) between them, in the language of
// Graphviz. Pure.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "components/topics/node/endpoint.h"

namespace sinew::inspect {

struct GraphLink {
  std::string participant;  // a unique name: two of one name carry a number
  std::string topic;
  bool writes = false;     // else reads
  bool inferred = false;   // by the table of topics, not seen: drawn dashed
  bool unmatched = false;  // a reader that no writer of the topic matches: drawn red
};

struct Graph {
  std::vector<std::string> participants;  // those without links too
  std::vector<GraphLink> links;
  std::map<std::string, std::string> hosts;  // of participants, where there are several hosts
  std::vector<std::string> unwritten;  // topics that are read and that nobody writes: drawn grey
};

// Graph by discovery. component_status, log and recording_progress, which all write or a recorder
// alone, only with `all`. A participant that reads its own topic, to hear of another owner, is a
// reader only when there is another writer. hosts: by node::ParticipantId, as far as known.
Graph GraphOfDomain(const std::vector<node::Endpoint>& endpoints, bool all,
                    const std::map<std::string, std::string>& hosts = {});

// Contents of a recording: its writers, and its participants by name and kind (component_status).
struct RecordedWriter {
  std::string topic;
  std::string participant;  // of the channel's metadata; empty: not recorded
};
struct RecordedParticipant {
  std::string name, kind;
};
// Readers are in no recording, and writers only in newer ones: what is missing is inferred from the
// parties of idl/README.md, readers without a condition only. Recorders only with `all`.
Graph GraphOfRecording(const std::vector<RecordedWriter>& writers,
                       const std::vector<RecordedParticipant>& participants, bool all);

std::string DotText(const Graph& graph, const std::string& title);

}  // namespace sinew::inspect
