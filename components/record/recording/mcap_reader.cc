#include "components/record/recording/mcap_reader.h"

#include <cstring>
#include <utility>

namespace sinew::recording {
namespace {

constexpr std::uint64_t kMagicSize = kMcapMagic.size();
constexpr std::uint64_t kSmallestFooterSize = McapRecord::kHeadSize + 8 + 8 + 4;

bool IsMagic(std::span<const std::byte> bytes) {
  return bytes.size() == kMagicSize &&
         std::memcmp(bytes.data(), kMcapMagic.data(), kMagicSize) == 0;
}

}  // namespace

McapReader::McapReader(ByteSource& source) : records_(source) {
  const std::uint64_t size = source.size();
  if (size < kMagicSize || !IsMagic(records_.ReadBytes(0, kMagicSize))) {
    throw McapError(0, "no MCAP file: the magic bytes are missing");
  }
  const bool whole = size >= 2 * kMagicSize + kSmallestFooterSize &&
                     IsMagic(records_.ReadBytes(size - kMagicSize, kMagicSize));
  const std::uint64_t end = whole ? size - kMagicSize : size;

  const McapRecord header = records_.ReadHead(kMagicSize, end);
  if (header.opcode != Opcode::kHeader) {
    throw McapError(kMagicSize,
                    "record " + OpcodeText(header.opcode) + ", expected the header 0x01");
  }
  header_ = Parse<McapHeader>(header.offset, records_.ReadContent(header));

  std::optional<McapContents> summary;
  if (whole) summary = ReadSummary(records_, end);
  contents_ = summary ? std::move(*summary) : ScanRecords(records_, header.end(), end, !whole);
}

const McapSchema* McapReader::SchemaOf(const McapChannel& channel) const {
  const auto found = contents_.schemas.find(channel.schema_id);
  return found == contents_.schemas.end() ? nullptr : &found->second;
}

std::vector<McapMetadata> McapReader::ReadMetadata() const {
  std::vector<McapMetadata> all;
  for (const std::uint64_t offset : contents_.metadata_offsets) {
    if (offset > records_.size())
      throw McapError(offset, "the metadata index points outside the file");
    const McapRecord record = records_.ReadHeadOf(Opcode::kMetadata, offset, "metadata");
    all.push_back(Parse<McapMetadata>(offset, records_.ReadContent(record)));
  }
  return all;
}

std::vector<McapAttachment> McapReader::ReadAttachments() const {
  std::vector<McapAttachment> all;
  for (const std::uint64_t offset : contents_.attachment_offsets) {
    if (offset > records_.size())
      throw McapError(offset, "the attachment index points outside the file");
    const McapRecord record = records_.ReadHeadOf(Opcode::kAttachment, offset, "an attachment");
    all.push_back(Parse<McapAttachment>(offset, records_.ReadContent(record)));
  }
  return all;
}

McapMessages McapReader::Messages(MessageFilter filter) const {
  return McapMessages(records_, contents_, std::move(filter));
}

}  // namespace sinew::recording
