// Fields of the records of an MCAP file in the order of the format, for both directions:
// mcap_record.cc reads, mcap_writer.cc writes what VisitFields hands to `fields`. Numbers and ids
// are as wide as their type, times (std::int64_t) have 64 bits, a text its length before it, the
// data of a message (a span) go to the record's end.
#pragma once

#include <concepts>
#include <type_traits>

#include "components/record/recording/mcap_record.h"

namespace sinew::recording {

// A text that is any bytes, others are UTF-8.
template <class Text>
struct Verbatim {
  explicit Verbatim(Text& bytes) : text(bytes) {}
  Text& text;
};
// The same with a length of 64 bits.
template <class Text>
struct LongText {
  explicit LongText(Text& bytes) : text(bytes) {}
  Text& text;
};
// A time that is 0 in files of ours and not read.
struct UnusedTime {};

// Record: const or not. Of an attachment without the checksum at its end.
template <class Fields, class Record>
void VisitFields(Fields fields, Record& r) {
  using R = std::remove_const_t<Record>;
  if constexpr (std::same_as<R, McapHeader>) {
    fields(r.profile, r.library);
  } else if constexpr (std::same_as<R, McapFooter>) {
    fields(r.summary_start, r.offsets_start, r.summary_crc);
  } else if constexpr (std::same_as<R, McapSchema>) {
    fields(r.id, r.name, r.encoding, Verbatim{r.data});
  } else if constexpr (std::same_as<R, McapChannel>) {
    fields(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
  } else if constexpr (std::same_as<R, McapMessage>) {
    fields(r.channel_id, r.sequence, r.log_time_ns, r.publish_time_ns, r.data);
  } else if constexpr (std::same_as<R, McapStatistics>) {
    fields(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count,
           r.chunk_count, r.start_time_ns, r.end_time_ns, r.channel_message_counts);
  } else if constexpr (std::same_as<R, McapChunkIndex>) {
    fields(r.start_time_ns, r.end_time_ns, r.offset, r.length, r.message_index_offsets,
           r.message_index_length, r.compression, r.compressed_size, r.uncompressed_size);
  } else if constexpr (std::same_as<R, McapMetadata>) {
    fields(r.name, r.values);
  } else {
    static_assert(std::same_as<R, McapAttachment>);
    fields(r.log_time_ns, UnusedTime{}, r.name, r.media_type, LongText{r.data});
  }
}

}  // namespace sinew::recording
