// The topics of a recording as tables: their columns, and a pass over their messages.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "tools/export_recording/columns.h"

namespace sinew::export_recording {

struct TopicTable {
  std::string topic;
  recording::MessageType type;
  std::unique_ptr<Columns> columns;
  std::size_t rows = 0;
};

// Is a message inside the range? By its own stamp (publish_time), s.
bool IsInside(const recording::McapMessage& message,
              const std::optional<recording::TimeRange>& range);

class Tables {
 public:
  // Reads the recording once for the sizes of the columns. topics: empty: all. A topic without a
  // message in the range has no table, nor has one that cannot be read (left_out). also: further
  // topics, where they are there. Throws UsageError naming the file: one that cannot be read or is
  // broken, a topic of `topics` that it lacks or that cannot be read, an empty result.
  Tables(const recording::RecordingPath& path, const std::set<std::string>& topics,
         const std::set<std::string>& also = {});

  // By topic.
  const std::vector<std::unique_ptr<TopicTable>>& list() const { return list_; }
  // By topic, why it cannot be read: "messages 'json' with ...".
  const recording::LeftOut& left_out() const { return left_out_; }
  // Why the end of the file is missing; empty: it is whole.
  std::string cut_off() const;

  using Take = std::function<void(std::size_t table, const recording::McapMessage& message)>;
  // In the order of reception, which is that of the file where the recording's clock was set back;
  // only: the number of one table, else all. Throws UsageError.
  void Read(const Take& take, std::optional<std::size_t> only = std::nullopt) const;

 private:
  void Widen();

  recording::RecordingPath path_;
  recording::FileSource source_;
  std::unique_ptr<recording::McapReader> reader_;
  std::vector<std::unique_ptr<TopicTable>> list_;
  recording::LeftOut left_out_;
  bool in_file_order_ = false;
};

// Counts of what was written of a topic.
struct Written {
  std::string topic;
  std::size_t messages = 0;
  std::size_t fields = 0;  // columns of a CSV file, arrays of an .npz file
};

// A file TOPIC.csv per topic into the folder, which must be there. Columns log_time_ns,
// publish_time_ns, then every entry of every field; enums by their labels, booleans as 0 and 1,
// numbers with as many digits as give them back exactly, entries not in use empty. Throws
// UsageError, std::runtime_error when a file cannot be written.
std::vector<Written> WriteCsv(const Tables& tables, const std::filesystem::path& folder);

// Arrays "TOPIC.FIELD" of shape (messages, entries...), "TOPIC.log_time_ns" and
// "TOPIC.publish_time_ns"; of an enum its numbers and "TOPIC.FIELD.labels". Entries not in use are
// NaN, 0 or empty. One topic at a time is in memory. Throws as WriteCsv; the file is then not
// there.
std::vector<Written> WriteNpz(const Tables& tables, const std::filesystem::path& file);

}  // namespace sinew::export_recording
