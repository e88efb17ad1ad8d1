// A recording as the page asks for it: what it has, and the messages of a span of time.
//
// Time is the stamp of the messages (header.stamp_ns), since in a recording of lockstep the time of
// reception says nothing. Of several sessions the first one is shown. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "components/recording/cdr.h"
#include "components/recording/file/file_io.h"
#include "components/recording/mcap_reader.h"

namespace sinew::live {

struct RecordedTopic {
  std::string topic, schema_name, schema;
  std::uint64_t messages = 0;  // in the file
};

class RecordedView {
 public:
  // Throws UsageError naming the file and what is wrong: no recording, no joint_state.
  explicit RecordedView(const std::filesystem::path& file);

  std::int64_t start_ns() const { return times_.front().stamp_ns; }
  std::int64_t end_ns() const { return times_.back().stamp_ns; }
  const std::vector<RecordedTopic>& topics() const { return topics_; }
  bool more_sessions() const { return more_sessions_; }

  struct Query {
    std::vector<std::string> topics;
    std::int64_t from_ns = 0, to_ns = 0;  // both inclusive
  };
  // Little-endian, one message after the other: index in topics() (uint16), stamp (int64), size of
  // the payload (uint32), payload. Topics that the file does not have are left out. Throws
  // UsageError when that is more than kMostBytes.
  std::string Messages(const Query& query) const;
  static constexpr std::size_t kMostBytes = 64u << 20;

 private:
  struct Times {
    std::int64_t stamp_ns, log_ns;
  };
  struct Reader {
    std::size_t index;  // in topics_
    std::unique_ptr<recording::IdlSchema> idl;
    recording::CdrField session, stamp;
  };

  std::string file_;
  recording::FileSource source_;
  recording::McapReader reader_;
  std::vector<RecordedTopic> topics_;
  std::map<recording::ChannelId, Reader> readers_;
  std::vector<Times> times_;  // of joint_state, in order of both
  std::int64_t session_ = 0;
  bool more_sessions_ = false;
};

// "topics=a,b&from_ns=0&to_ns=9". Throws UsageError naming the part that is missing or wrong.
RecordedView::Query ParseQuery(const std::string& query);

}  // namespace sinew::live
