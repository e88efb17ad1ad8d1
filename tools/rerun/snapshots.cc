#include "tools/rerun/snapshots.h"

#include <sinew_idl/snapshot.h>

#include <set>
#include <utility>

namespace sinew::rerun {
namespace {

// A snapshot whose parts come one after the other.
struct Gathered {
  Snapshot snapshot;
  std::uint32_t next_part = 0;
};

}  // namespace

std::map<std::string, Snapshot> SnapshotsUpTo(const recording::McapReader& reader,
                                              const std::string& file, const Session& session,
                                              std::uint64_t last_tick) {
  CheckTypes(reader, file, {"component_snapshot"});
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{"component_snapshot"};
  filter.in_file_order = session.in_file_order;
  recording::McapMessages messages = reader.Messages(filter);
  std::map<std::string, Snapshot> whole;
  std::map<std::string, Gathered> gathered;
  recording::McapMessage message;
  while (messages.Next(&message)) {
    msg::ComponentSnapshot part;
    if (!node::Decode({message.data.begin(), message.data.end()}, &part)) continue;
    if (part.header.session_id != session.id || part.header.tick > last_tick) continue;
    const std::string name = part.name;
    Gathered& now = gathered[name];
    if (part.part == 0) now = {{part.header.tick, part.version, {}}, 0};
    if (part.part != now.next_part || part.header.tick != now.snapshot.tick) continue;
    const auto* begin = reinterpret_cast<const std::byte*>(part.content.data());
    now.snapshot.content.insert(now.snapshot.content.end(), begin, begin + part.content.size());
    if (++now.next_part == part.part_count) whole[name] = std::move(now.snapshot);
  }
  return whole;
}

}  // namespace sinew::rerun
