// Lines of the topic `log`, live or recorded, as they can be shown. Pure.
#pragma once

#include <sinew_idl/log.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "components/record/recording/cdr.h"

namespace sinew::inspect {

struct LogText {
  std::int64_t time_ns = 0;  // epoch, by the clock of its host
  msg::LogLevel level{};
  std::string name, text;  // printable
};

// Reads them by the schema of their topic.
class LogReader {
 public:
  // Throws CdrError: the type has no time, level, name or text.
  explicit LogReader(const recording::IdlType& type);
  // Throws CdrError: the payload is too short.
  LogText Read(std::span<const std::byte> payload) const;

 private:
  recording::CdrField time_ns_, level_, name_, text_;
};

}  // namespace sinew::inspect
