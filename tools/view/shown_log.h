// Lines of the topic `log` as the page shows them, live or of a recording: the newest ones,
// bounded.
//
// Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/inspect/log_lines.h"

namespace sinew::live {

// Lines of a domain as they come, numbered from 1 on.
class ShownLog {
 public:
  static constexpr std::size_t kMost = 500;  // that a page shows

  void Add(inspect::LogText line);
  // JSON of query "after=N": last, the number of the newest line, and lines, those that came after
  // line N, each with time_ms (epoch), level, name and text. Throws UsageError: no such query.
  std::string After(const std::string& query) const;

 private:
  mutable std::mutex mutex_;
  std::deque<inspect::LogText> lines_;  // guarded
  std::uint64_t last_ = 0;              // guarded
};

// level, name and text.
nlohmann::ordered_json LogRow(const inspect::LogText& line);

}  // namespace sinew::live
