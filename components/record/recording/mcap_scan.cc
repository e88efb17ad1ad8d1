#include <algorithm>
#include <map>

#include "components/record/recording/mcap_contents.h"

namespace sinew::recording {
namespace {

// Messages of one record or chunk, to be added to the statistics at once.
struct Tally {
  std::uint64_t messages = 0;
  std::int64_t start_time_ns = 0;
  std::int64_t end_time_ns = 0;
  std::map<ChannelId, std::uint64_t> channel_counts;

  void Add(const McapMessage& head) {
    start_time_ns = messages == 0 ? head.log_time_ns : std::min(start_time_ns, head.log_time_ns);
    end_time_ns = messages == 0 ? head.log_time_ns : std::max(end_time_ns, head.log_time_ns);
    ++messages;
    ++channel_counts[head.channel_id];
  }
};

void AddTally(const Tally& tally, McapStatistics* statistics) {
  if (tally.messages == 0) return;
  const bool first = statistics->message_count == 0;
  statistics->start_time_ns =
      first ? tally.start_time_ns : std::min(statistics->start_time_ns, tally.start_time_ns);
  statistics->end_time_ns =
      first ? tally.end_time_ns : std::max(statistics->end_time_ns, tally.end_time_ns);
  statistics->message_count += tally.messages;
  for (const auto& [channel, count] : tally.channel_counts) {
    statistics->channel_message_counts[channel] += count;
  }
}

// Throws McapError where the chunk is broken; none of its messages counts then.
void AddChunk(std::uint64_t offset, const Bytes& content, McapContents* contents) {
  McapChunkIndex index;
  const Bytes records = OpenChunk(offset, content, &index);
  Tally tally;
  ForEachInChunk(
      offset, records, [&](Opcode opcode, std::size_t, std::span<const std::byte> inner) {
        if (opcode == Opcode::kSchema)
          contents->AddSchema(offset, Parse<McapSchema>(offset, inner));
        if (opcode == Opcode::kChannel)
          contents->AddChannel(offset, Parse<McapChannel>(offset, inner));
        if (opcode != Opcode::kMessage) return;
        const McapMessage head = Parse<McapMessage>(offset, inner);
        if (!contents->channels.contains(head.channel_id)) {
          throw McapError(offset,
                          "a message in the chunk names a channel that the file does not have");
        }
        tally.Add(head);
      });
  if (tally.messages > 0) {
    index.start_time_ns = tally.start_time_ns;
    index.end_time_ns = tally.end_time_ns;
  }
  AddTally(tally, &contents->statistics);
  contents->chunks.push_back(std::move(index));
}

void AddLoose(const McapRecord& record, const Bytes& content, McapContents* contents) {
  const McapMessage head = Parse<McapMessage>(record.offset, content);
  if (!contents->channels.contains(head.channel_id)) {
    throw McapError(record.offset, "a message names a channel that the file does not have");
  }
  contents->loose.push_back({head.log_time_ns, record.offset, record.size});
  Tally tally;
  tally.Add(head);
  AddTally(tally, &contents->statistics);
}

void AddToScan(const McapRecords& records, const McapRecord& record, McapContents* contents) {
  const std::uint64_t offset = record.offset;
  switch (record.opcode) {
    case Opcode::kSchema:
      return contents->AddSchema(offset, Parse<McapSchema>(offset, records.ReadContent(record)));
    case Opcode::kChannel:
      return contents->AddChannel(offset, Parse<McapChannel>(offset, records.ReadContent(record)));
    case Opcode::kChunk:
      return AddChunk(offset, records.ReadContent(record), contents);
    case Opcode::kMessage:
      return AddLoose(record, records.ReadContent(record), contents);
    case Opcode::kMetadata:
      contents->metadata_offsets.push_back(offset);
      return;
    case Opcode::kAttachment:
      contents->attachment_offsets.push_back(offset);
      return;
    default:
      return;  // indexes, and records of later versions
  }
}

}  // namespace

McapContents ScanRecords(const McapRecords& records, std::uint64_t start, std::uint64_t end,
                         bool cut_off) {
  McapContents contents;
  std::uint64_t offset = start;
  std::string reason = "the file ends before its summary";
  try {
    while (offset < end) {
      const McapRecord record = records.ReadHead(offset, end);
      if (record.opcode == Opcode::kDataEnd || record.opcode == Opcode::kFooter) {
        reason = "the file ends inside its summary";
        break;
      }
      AddToScan(records, record, &contents);
      offset = record.end();
    }
  } catch (const McapError& error) {
    if (!cut_off) throw;
    reason = error.what();
  }
  if (const McapChannel* channel = contents.WithoutSchema(); channel != nullptr && !cut_off) {
    throw McapError(offset, "channel '" + channel->topic +
                                "' names a schema that the file does "
                                "not have");
  }
  McapStatistics& statistics = contents.statistics;
  statistics.schema_count = static_cast<std::uint16_t>(contents.schemas.size());
  statistics.channel_count = static_cast<std::uint32_t>(contents.channels.size());
  statistics.chunk_count = static_cast<std::uint32_t>(contents.chunks.size());
  statistics.metadata_count = static_cast<std::uint32_t>(contents.metadata_offsets.size());
  statistics.attachment_count = static_cast<std::uint32_t>(contents.attachment_offsets.size());
  if (cut_off) {
    contents.recovery = Recovery{offset, end - offset, statistics.message_count, reason};
  }
  return contents;
}

}  // namespace sinew::recording
