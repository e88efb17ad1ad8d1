// The snapshots of a recording (topic component_snapshot), put together from their parts.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/codec.h"
#include "tools/rerun/recorded_ticks.h"

namespace sinew::rerun {

struct Snapshot {
  std::uint64_t tick = 0;  // after this cycle
  std::uint32_t version = 0;
  node::Bytes content;
};

// The last whole snapshot of each participant, by name, of the session up to `last_tick`. One that
// lacks a part counts as none. `file` is named in messages. Throws UsageError when they are of
// another type than this build's; recording::McapError.
std::map<std::string, Snapshot> SnapshotsUpTo(const recording::McapReader& reader,
                                              const std::string& file, const Session& session,
                                              std::uint64_t last_tick);

}  // namespace sinew::rerun
