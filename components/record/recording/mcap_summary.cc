
#include "components/record/recording/compression.h"
#include "components/record/recording/mcap_contents.h"

namespace sinew::recording {
namespace {

constexpr std::uint64_t kFooterContentSize = 8 + 8 + 4;
constexpr std::uint64_t kFooterSize = McapRecord::kHeadSize + kFooterContentSize;
constexpr std::uint64_t kCrcSize = 4;

void AddSummaryRecord(const McapRecord& record, const Bytes& content, McapContents* contents) {
  switch (record.opcode) {
    case Opcode::kSchema:
      return contents->AddSchema(record.offset, Parse<McapSchema>(record.offset, content));
    case Opcode::kChannel:
      return contents->AddChannel(record.offset, Parse<McapChannel>(record.offset, content));
    case Opcode::kStatistics:
      contents->statistics = Parse<McapStatistics>(record.offset, content);
      return;
    case Opcode::kChunkIndex:
      contents->chunks.push_back(Parse<McapChunkIndex>(record.offset, content));
      return;
    case Opcode::kMetadataIndex:
      contents->metadata_offsets.push_back(
          ParseIndexedOffset(record.offset, record.opcode, content));
      return;
    case Opcode::kAttachmentIndex:
      contents->attachment_offsets.push_back(
          ParseIndexedOffset(record.offset, record.opcode, content));
      return;
    default:
      return;  // summary offsets, and records of later versions
  }
}

// Messages outside of chunks have no index. The heads of what is neither an indexed chunk nor the
// message indexes behind it are read: few.
bool HasLooseMessages(const McapRecords& records, const std::vector<McapChunkIndex>& chunks,
                      std::uint64_t end) {
  std::map<std::uint64_t, std::uint64_t> ends;
  for (const McapChunkIndex& chunk : chunks) {
    const std::uint64_t chunk_end = chunk.offset + chunk.length;
    const bool inside = chunk.message_index_length <= end - chunk_end;
    ends[chunk.offset] = chunk_end + (inside ? chunk.message_index_length : 0);
  }
  for (std::uint64_t offset = kMcapMagic.size(); offset < end;) {
    if (const auto chunk = ends.find(offset); chunk != ends.end()) {
      offset = chunk->second;
      continue;
    }
    const McapRecord record = records.ReadHead(offset, end);
    if (record.opcode == Opcode::kMessage) return true;
    offset = record.end();
  }
  return false;
}

}  // namespace

void McapContents::AddSchema(std::uint64_t offset, McapSchema schema) {
  if (schema.id == SchemaId{0}) return;
  const auto [known, added] = schemas.try_emplace(schema.id, schema);
  if (!added && (known->second.name != schema.name || known->second.data != schema.data)) {
    throw McapError(offset, "schema " + std::to_string(static_cast<int>(schema.id)) +
                                " is there twice, differently");
  }
}

void McapContents::AddChannel(std::uint64_t offset, McapChannel channel) {
  const auto [known, added] = channels.try_emplace(channel.id, channel);
  if (!added &&
      (known->second.topic != channel.topic || known->second.schema_id != channel.schema_id)) {
    throw McapError(offset, "channel " + std::to_string(static_cast<int>(channel.id)) +
                                " is there twice, differently");
  }
}

const McapChannel* McapContents::WithoutSchema() const {
  for (const auto& [id, channel] : channels) {
    if (channel.schema_id != SchemaId{0} && !schemas.contains(channel.schema_id)) return &channel;
  }
  return nullptr;
}

std::optional<McapContents> ReadSummary(const McapRecords& records, std::uint64_t end) {
  const std::uint64_t footer_offset = end - kFooterSize;
  const McapRecord record = records.ReadHead(footer_offset, end);
  if (record.opcode != Opcode::kFooter || record.size != kFooterContentSize) {
    throw McapError(footer_offset,
                    "record " + OpcodeText(record.opcode) + ", expected the footer 0x02");
  }
  const McapFooter footer = Parse<McapFooter>(footer_offset, records.ReadContent(record));
  if (footer.summary_start == 0) return std::nullopt;
  if (footer.summary_start < kMcapMagic.size() || footer.summary_start > footer_offset ||
      (footer.offsets_start != 0 &&
       (footer.offsets_start < footer.summary_start || footer.offsets_start > footer_offset))) {
    throw McapError(footer_offset, "the footer points outside the file");
  }
  if (footer.summary_crc != 0 &&
      Crc32(records.ReadBytes(footer.summary_start, end - kCrcSize - footer.summary_start)) !=
          footer.summary_crc) {
    throw McapError(footer.summary_start, "the checksum of the summary is wrong");
  }
  const std::uint64_t summary_end =
      footer.offsets_start == 0 ? footer_offset : footer.offsets_start;
  McapContents contents;
  bool statistics = false;
  for (std::uint64_t offset = footer.summary_start; offset < summary_end;) {
    const McapRecord inner = records.ReadHead(offset, summary_end);
    AddSummaryRecord(inner, records.ReadContent(inner), &contents);
    statistics = statistics || inner.opcode == Opcode::kStatistics;
    offset = inner.end();
  }
  for (const McapChunkIndex& chunk : contents.chunks) {
    if (chunk.offset < kMcapMagic.size() || chunk.offset > footer.summary_start ||
        chunk.length > footer.summary_start - chunk.offset) {
      throw McapError(footer.summary_start, "the chunk index points outside the file");
    }
  }
  // A summary may repeat schemas, channels and indexes or leave them out (specification); what it
  // leaves out, and messages outside of chunks, only a scan finds.
  const McapStatistics& counts = contents.statistics;
  const bool is_complete =
      statistics && contents.WithoutSchema() == nullptr &&
      counts.channel_count == contents.channels.size() &&
      counts.chunk_count == contents.chunks.size() &&
      counts.metadata_count == contents.metadata_offsets.size() &&
      counts.attachment_count == contents.attachment_offsets.size() &&
      (counts.message_count == 0 || (!contents.chunks.empty() && !contents.channels.empty()));
  if (!is_complete || HasLooseMessages(records, contents.chunks, footer.summary_start)) {
    return std::nullopt;
  }
  return contents;
}

}  // namespace sinew::recording
