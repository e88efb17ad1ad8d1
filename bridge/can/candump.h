// The log format of candump -l, a line a frame: "(1436509052.249713) can0 044#2A366C2BBA". Pure
// text to frames and back; files are read by bridge/can/file. Remote frames are "123#R8", extended
// identifiers have eight digits, error frames carry 0x20000000 in the identifier; the raw DLC that
// candump -8 appends to eight bytes ("_9" to "_F") is read and not kept. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/can/frame.h"

namespace sinew::can {

struct LogLine {
  std::int64_t stamp_ns =
      0;  // a multiple of 1000 when it comes from a file: the format has microseconds
  std::string interface;
  Frame frame;
  friend bool operator==(const LogLine&, const LogLine&) = default;
};

std::string FormatCandump(const LogLine& line);

// Nothing when the line is not of this format, or the frame impossible (CAN FD lines are).
std::optional<LogLine> ParseCandump(std::string_view line);

// A frame of CAN XL, "(0.000000) can0 45123#81:00:12345678#11223344": ParseCandump gives nothing.
bool IsCanXl(std::string_view line);

}  // namespace sinew::can
