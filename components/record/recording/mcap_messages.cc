#include "components/record/recording/mcap_messages.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "components/record/recording/mcap_contents.h"

namespace sinew::recording {

// Chunks are opened in the order of their start; a message is given once no unopened chunk can hold
// an earlier one.
struct McapMessages::Impl {
  struct Entry {
    std::int64_t log_time_ns;  // in file order: 0
    std::uint64_t file_order;  // chunk or loose message, then position inside
    std::size_t inner_order;
    std::shared_ptr<const Bytes> bytes;
    std::size_t start;
    std::size_t size;

    bool operator>(const Entry& other) const {
      return std::tie(log_time_ns, file_order, inner_order) >
             std::tie(other.log_time_ns, other.file_order, other.inner_order);
    }
  };
  struct Part {  // a chunk or a loose message not opened yet
    std::int64_t start_time_ns;
    std::uint64_t offset;
    std::uint64_t size;
    bool chunk;
  };

  const McapRecords* records = nullptr;
  const McapContents* contents = nullptr;
  MessageFilter filter;
  std::set<ChannelId> wanted;
  std::deque<Part> parts;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  Entry current{};

  void AddMessage(const std::shared_ptr<const Bytes>& bytes, std::span<const std::byte> content,
                  std::uint64_t offset, std::size_t inner) {
    const McapMessage head = Parse<McapMessage>(offset, content);
    if (!contents->channels.contains(head.channel_id)) {
      throw McapError(offset, "a message names a channel that the file does not have");
    }
    if (!wanted.contains(head.channel_id)) return;
    if (head.log_time_ns < filter.start_ns || head.log_time_ns > filter.end_ns) return;
    waiting.push({filter.in_file_order ? 0 : head.log_time_ns, offset, inner, bytes,
                  static_cast<std::size_t>(content.data() - bytes->data()), content.size()});
  }

  void OpenPart() {
    const Part part = parts.front();
    parts.pop_front();
    if (!part.chunk) {
      const auto bytes = std::make_shared<const Bytes>(
          records->ReadBytes(part.offset + McapRecord::kHeadSize, part.size));
      AddMessage(bytes, *bytes, part.offset, 0);
      return;
    }
    const McapRecord record = records->ReadHeadOf(Opcode::kChunk, part.offset, "a chunk");
    McapChunkIndex index;
    const auto bytes =
        std::make_shared<const Bytes>(OpenChunk(part.offset, records->ReadContent(record), &index));
    ForEachInChunk(part.offset, *bytes,
                   [&](Opcode opcode, std::size_t at, std::span<const std::byte> content) {
                     if (opcode == Opcode::kMessage) AddMessage(bytes, content, part.offset, at);
                   });
  }
};

McapMessages::McapMessages(const McapRecords& records, const McapContents& contents,
                           MessageFilter filter)
    : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  impl.records = &records;
  impl.contents = &contents;
  for (const auto& [id, channel] : contents.channels) {
    if (!filter.topics || filter.topics->contains(channel.topic)) impl.wanted.insert(id);
  }
  for (const McapChunkIndex& chunk : contents.chunks) {
    if (chunk.end_time_ns < filter.start_ns || chunk.start_time_ns > filter.end_ns) continue;
    const bool unknown = chunk.message_index_offsets.empty();
    const bool any =
        std::any_of(chunk.message_index_offsets.begin(), chunk.message_index_offsets.end(),
                    [&](const auto& entry) { return impl.wanted.contains(entry.first); });
    if (unknown || any)
      impl.parts.push_back(
          {filter.in_file_order ? 0 : chunk.start_time_ns, chunk.offset, chunk.length, true});
  }
  for (const McapLooseMessage& loose : contents.loose) {
    impl.parts.push_back(
        {filter.in_file_order ? 0 : loose.log_time_ns, loose.offset, loose.size, false});
  }
  std::stable_sort(impl.parts.begin(), impl.parts.end(), [](const auto& a, const auto& b) {
    return std::tie(a.start_time_ns, a.offset) < std::tie(b.start_time_ns, b.offset);
  });
  impl.filter = std::move(filter);
}

McapMessages::McapMessages(McapMessages&&) noexcept = default;
McapMessages::~McapMessages() = default;

bool McapMessages::Next(McapMessage* message) {
  Impl& impl = *impl_;
  // In file order nothing of a later part comes before what waits.
  while (!impl.parts.empty() && (impl.waiting.empty() || (!impl.filter.in_file_order &&
                                                          impl.parts.front().start_time_ns <=
                                                              impl.waiting.top().log_time_ns))) {
    impl.OpenPart();
  }
  if (impl.waiting.empty()) return false;
  impl.current = impl.waiting.top();
  impl.waiting.pop();
  *message = Parse<McapMessage>(
      impl.current.file_order,
      std::span(*impl.current.bytes).subspan(impl.current.start, impl.current.size));
  return true;
}

}  // namespace sinew::recording
