#include "bridge/can/candump.h"

#include <charconv>
#include <cstdio>

namespace sinew::can {
namespace {

constexpr std::uint32_t kBitRateSwitch = 1;       // CANFD_BRS
constexpr std::uint32_t kErrorFlag = 0x20000000;  // CAN_ERR_FLAG of linux/can.h

// Takes `count` hexadecimal digits off the front.
std::optional<std::uint32_t> TakeHex(std::string_view& text, std::size_t count) {
  if (text.size() < count) return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + count, value, 16);
  if (error != std::errc{} || end != text.data() + count) return std::nullopt;
  text.remove_prefix(count);
  return value;
}

std::optional<std::int64_t> TakeDecimal(std::string_view& text) {
  if (text.empty() || text.front() == '-') return std::nullopt;  // from_chars takes a sign
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end == text.data() || value < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

bool Take(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

// The raw DLC of a classic frame of eight bytes, whose lengths 9 to 15 mean eight.
bool TakeRawDlc(std::string_view& text) {
  if (!Take(text, '_')) return false;
  const auto dlc = TakeHex(text, 1);
  return dlc && *dlc > kMaxDataBytes && text.empty();
}

// Data bytes; of an FD frame a second # and its flags first; or R and the length of a remote frame.
bool TakePayload(std::string_view& text, Frame& frame) {
  if (Take(text, '#')) {
    const auto flags = TakeHex(text, 1);
    if (!flags) return false;
    frame.fd = true;
    frame.bit_rate_switch = (*flags & kBitRateSwitch) != 0;
  }
  if (Take(text, 'R')) {
    frame.remote = true;
    if (text.empty()) return true;
    if (text.front() < '0' || text.front() > '8') return false;
    frame.length = static_cast<std::uint8_t>(text.front() - '0');
    text.remove_prefix(1);
    return text.empty() || (frame.length == kMaxDataBytes && TakeRawDlc(text));
  }
  while (!text.empty()) {
    if (!frame.fd && frame.length == kMaxDataBytes) return TakeRawDlc(text);
    if (frame.length == kMaxFdDataBytes) return false;
    const auto byte = TakeHex(text, 2);
    if (!byte) return false;
    frame.data[frame.length++] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

}  // namespace

std::string FormatCandump(const LogLine& line) {
  const Frame& frame = line.frame;
  const std::int64_t stamp_us = line.stamp_ns / 1000;
  char text[64];
  std::snprintf(text, sizeof text, "(%010lld.%06lld) ",
                static_cast<long long>(stamp_us / 1'000'000),
                static_cast<long long>(stamp_us % 1'000'000));
  std::string result = text + line.interface;
  std::snprintf(text, sizeof text, frame.extended || frame.error ? " %08X#" : " %03X#",
                frame.id | (frame.error ? kErrorFlag : 0U));
  result += text;
  if (frame.remote) {
    result += 'R';
    if (frame.length > 0) result += static_cast<char>('0' + frame.length);
    return result;
  }
  if (frame.fd) result += frame.bit_rate_switch ? "#1" : "#0";
  for (std::size_t i = 0; i < frame.length && i < frame.data.size(); ++i) {
    std::snprintf(text, sizeof text, "%02X", frame.data[i]);
    result += text;
  }
  return result;
}

std::optional<LogLine> ParseCandump(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  // Newer versions append the direction.
  if (line.ends_with(" T") || line.ends_with(" R")) line.remove_suffix(2);
  LogLine result;
  if (!Take(line, '(')) return std::nullopt;
  const auto seconds = TakeDecimal(line);
  if (!seconds || *seconds > 9'000'000'000 || !Take(line, '.')) return std::nullopt;
  const std::size_t digits_before = line.size();
  const auto fraction = TakeDecimal(line);
  if (!fraction || digits_before - line.size() != 6 || !Take(line, ')') || !Take(line, ' ')) {
    return std::nullopt;
  }
  result.stamp_ns = *seconds * 1'000'000'000 + *fraction * 1000;

  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos || space == 0) return std::nullopt;
  result.interface = line.substr(0, space);
  line.remove_prefix(space + 1);

  const std::size_t hash = line.find('#');
  if (hash != 3 && hash != 8) return std::nullopt;
  const auto id = TakeHex(line, hash);
  if (!id || !Take(line, '#')) return std::nullopt;
  result.frame.id = *id;
  if (hash == 8) {
    result.frame.error = (*id & kErrorFlag) != 0;
    result.frame.extended = !result.frame.error;
    result.frame.id &= ~kErrorFlag;
  }
  if (!TakePayload(line, result.frame) || !IsValid(result.frame)) return std::nullopt;
  return result;
}

bool IsCanXl(std::string_view line) {
  const std::size_t hash = line.find('#');
  return hash != std::string_view::npos && line.substr(hash + 1).find(':') == 2;
}

}  // namespace sinew::can
