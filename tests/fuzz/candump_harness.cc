#include <algorithm>
#include <string>

#include "bridge/can/candump.h"
#include "tests/fuzz/harness.h"
#include "tests/fuzz/property.h"

namespace sinew::fuzz {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsHex(char c) { return IsDigit(c) || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f'); }

// The format, read a second time by hand: "(seconds.microseconds) interface identifier#payload",
// with a second # and a digit of flags in front of an FD frame's bytes, and what newer versions
// append.
bool IsOfTheFormat(std::string_view text) {
  while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
  if (text.ends_with(" T") || text.ends_with(" R")) text.remove_suffix(2);
  const auto take = [&text](auto accepts) {
    std::size_t n = 0;
    while (n < text.size() && accepts(text[n])) ++n;
    const std::string_view taken = text.substr(0, n);
    text.remove_prefix(n);
    return taken;
  };
  const auto is = [&text](char c) {
    if (text.empty() || text.front() != c) return false;
    text.remove_prefix(1);
    return true;
  };
  if (!is('(') || take(IsDigit).empty() || !is('.') || take(IsDigit).size() != 6 || !is(')') ||
      !is(' ') || take([](char c) { return c != ' '; }).empty() || !is(' ')) {
    return false;
  }
  const std::size_t id = take(IsHex).size();
  if ((id != 3 && id != 8) || !is('#')) return false;
  if (is('R')) {
    return text.empty() || (text.size() == 1 && text.front() >= '0' && text.front() <= '8');
  }
  if (is('#')) {
    if (text.empty() || !IsHex(text.front())) return false;
    text.remove_prefix(1);
    return text.size() % 2 == 0 && can::IsFdLength(static_cast<int>(text.size() / 2)) &&
           std::all_of(text.begin(), text.end(), IsHex);
  }
  return text.size() <= 16 && text.size() % 2 == 0 && std::all_of(text.begin(), text.end(), IsHex);
}

}  // namespace

void RunCandump(std::span<const std::uint8_t> input) {
  const std::string text(input.begin(), input.end());
  if (const auto line = can::ParseCandump(text)) {
    Check(IsOfTheFormat(text), "a line of another format was taken");
    Check(can::IsValid(line->frame), "an impossible frame was taken");
    Check(line->stamp_ns >= 0 && line->stamp_ns % 1000 == 0, "a stamp the format cannot say");
    const auto again = can::ParseCandump(can::FormatCandump(*line));
    Check(again.has_value() && *again == *line, "a line does not come back from its own text");
  }
  // The other way round: the same bytes as a frame.
  Bytes bytes(input);
  can::LogLine line;
  line.stamp_ns = static_cast<std::int64_t>(bytes.Take<std::uint32_t>()) * 1000;
  line.interface = "can0";
  line.frame = bytes.Frame();
  line.frame.length = static_cast<std::uint8_t>(line.frame.length % 9);
  line.frame.id &= line.frame.extended || line.frame.error ? 0x1FFFFFFFU : 0x7FFU;
  if (line.frame.error) line.frame.extended = false;  // the format does not distinguish them
  const std::size_t used = line.frame.remote ? 0 : line.frame.length;
  std::fill(line.frame.data.begin() + static_cast<std::ptrdiff_t>(used), line.frame.data.end(),
            std::uint8_t{0});
  Check(can::IsValid(line.frame), "the harness made an impossible frame");
  const auto back = can::ParseCandump(can::FormatCandump(line));
  Check(back.has_value() && *back == line, "a frame does not come back from its line");
}

std::vector<Input> CandumpSeeds() {
  std::vector<Input> seeds;
  for (const std::string_view line :
       {"(1436509052.249713) can0 044#2A366C2BBA", "(0000000000.000001) vcan1 7FF#",
        "(1436509052.249713) can0 12345678#0011223344556677", "(1.000000) c 123#R",
        "(1.000000) can0 00000123#R8", "(1436509053.650713) can0 20000004#0004000000000000",
        "(1436509052.249713) can0 123#DEADBEEF T\r", "(1436509052.249713) can0 123#DEADBEEF R",
        "(1436509052.249713)  can0 123##1DEADBEEF", "(9000000000.999999) a 000#00"}) {
    seeds.emplace_back(line.begin(), line.end());
  }
  return seeds;
}

}  // namespace sinew::fuzz
