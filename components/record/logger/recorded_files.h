// Messages into MCAP files: a channel per topic and writer, files one after another, each readable
// without the others, and what was lost beside what was recorded.
//
// Every file begins with the metadata, the attachments and the schemas of all topics, then with the
// samples of what came before it that are still valid (latched_samples.h), and ends with a metadata
// record `sinew.losses`. Thread: one at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "components/record/logger/latched_samples.h"
#include "components/record/logger/recorded_message.h"
#include "components/record/logger/recording_sink.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"

namespace sinew::logger {

struct TopicLosses {
  std::uint64_t lost = 0;       // reported by DDS (SAMPLE_LOST)
  std::uint64_t missing = 0;    // gaps in the numbers of a writer's samples
  std::uint64_t dropped = 0;    // received, but the recorder's queue was full
  std::uint64_t malformed = 0;  // recorded, but they do not fit their type

  bool operator==(const TopicLosses&) const = default;
};

struct FilesOptions {
  recording::Compression compression = recording::Compression::kZstd;
  std::chrono::milliseconds chunk_span{100};  // the longest time that a message waits in a chunk
  std::uint64_t split_bytes = 0;              // a file ends with the chunk that reaches it; 0: none
  std::chrono::nanoseconds split_span{0};     // of reception times in a file; 0: none
  std::chrono::milliseconds sync_span{0};     // from Sync to Sync; 0: at the end of a file only
  std::vector<recording::McapAttachment> attachments;
  // Metadata of a channel on its writer, such as its participant's name.
  std::function<recording::TextMap(const WriterGuid&)> describe_writer;
  // Samples of the files before it that a file repeats, by topic; empty: nothing.
  std::vector<Repeats> repeats;
  std::function<bool(const WriterGuid&)> writer_is_live;  // none: all are
};

class RecordedFiles {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  // Keeps a reference to the sink.
  RecordedFiles(RecordingSink& sink, std::vector<recording::TopicSchema> topics,
                std::vector<recording::McapMetadata> metadata, FilesOptions options);

  bool open() const { return writer_.has_value(); }
  // Begins the next file; `more` belongs to this one alone.
  recording::IoStatus Begin(const std::vector<recording::McapMetadata>& more = {});
  // A file must be open. Ends it before the message and begins the next one where the split says.
  // Before the first message of a file goes what is repeated, with the message's reception time, as
  // if it had been received when the file began; stamp, writer and sequence number are its own.
  recording::IoStatus Write(const RecordedMessage& message);
  // A message that goes into no file, older than all that will: the next file repeats it if it is
  // to be repeated.
  void Pass(const RecordedMessage& message);
  // Closes a chunk that is older than chunk_span, syncs, and notes losses (at most every 10 s).
  // To be called much more often than every chunk_span.
  recording::IoStatus Tend(Instant now);
  recording::IoStatus End();

  void SetLosses(std::vector<TopicLosses> losses) { losses_ = std::move(losses); }  // by topic
  int files() const { return next_number_; }                                        // begun so far
  std::uint64_t messages() const { return messages_; }  // in files, repeated ones not counted
  std::uint64_t bytes() const;                          // of all files

 private:
  struct Channels {
    recording::SchemaId schema{};
    std::map<WriterGuid, recording::ChannelId> by_writer;
  };
  // writer: what is known of the message's.
  recording::IoStatus AddChannel(const RecordedMessage& message, recording::TextMap writer,
                                 recording::ChannelId* id);
  recording::IoStatus WriteTo(recording::ChannelId channel, const RecordedMessage& message,
                              std::int64_t log_time_ns);
  recording::IoStatus WriteRepeated(std::int64_t log_time_ns);
  recording::IoStatus WriteLosses();
  bool SplitIsDue(const RecordedMessage& message) const;

  RecordingSink& sink_;
  const std::vector<recording::TopicSchema> topics_;
  const std::vector<recording::McapMetadata> metadata_;
  const FilesOptions options_;

  LatchedSamples latched_;
  std::optional<recording::McapWriter> writer_;  // of the open file
  std::vector<Channels> channels_;               // of the open file, by topic
  std::optional<std::int64_t> first_ns_;         // reception of its first message
  std::optional<Instant> chunk_since_;           // when its open chunk was seen first
  std::uint64_t chunks_seen_ = 0;
  std::uint64_t bytes_synced_ = 0;
  std::vector<TopicLosses> losses_, written_losses_;
  Instant last_sync_{}, last_losses_{};
  int next_number_ = 0;
  std::uint64_t messages_ = 0;
  std::uint64_t bytes_before_ = 0;  // of the files that have ended
};

}  // namespace sinew::logger
