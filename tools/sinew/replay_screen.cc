#include "tools/sinew/replay_screen.h"

#include <algorithm>

#include "components/base/types/text.h"
#include "components/record/logger/player/pace.h"

namespace sinew::tools {

namespace {

constexpr std::size_t kReplayBar = 20;  // columns
constexpr char kEscape = '\x1b';

// ECMA-48 cursor keys, with [ or (application mode) O.
std::optional<std::string> ArrowRequest(char final) {
  switch (final) {
    case 'A':
      return "seek +60";
    case 'B':
      return "seek -60";
    case 'C':
      return "seek +5";
    case 'D':
      return "seek -5";
    default:
      return std::nullopt;
  }
}

std::optional<std::string> KeyRequest(char key) {
  switch (key) {
    case ' ':
      return "toggle";
    case 's':
      return "step";
    case '+':
    case '=':  // the same key without shift
      return "faster";
    case '-':
      return "slower";
    case 'q':
      return "quit";
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<std::string> KeyDecoder::Take(char byte) {
  if (byte == kEscape) {
    escape_ = byte;
    return std::nullopt;
  }
  if (escape_.empty()) return KeyRequest(byte);
  if (escape_.size() == 1) {
    if (byte == '[' || byte == 'O') {
      escape_ += byte;
      return std::nullopt;
    }
    escape_.clear();
    return KeyRequest(byte);  // the escape key alone, then another
  }
  // Parameters (of shift, control) are digits and ';'; the final byte ends the sequence.
  if ((byte >= '0' && byte <= '9') || byte == ';') return std::nullopt;
  escape_.clear();
  return ArrowRequest(byte);
}

std::string ReplayLine(const logger::PlayStatus& status, std::size_t width) {
  if (status.waiting) return std::string("waiting for readers  q quits").substr(0, width);
  const double share =
      status.duration_s > 0.0 ? std::clamp(status.position_s / status.duration_s, 0.0, 1.0) : 1.0;
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(kReplayBar));
  std::string line = types::Text("%.1f of %.1f s ", status.position_s, status.duration_s);
  line += "[" + std::string(filled, '#') + std::string(kReplayBar - filled, '-') + "]";
  line += status.rate == logger::kMaxRate ? " max" : types::Text(" x%g", status.rate);
  if (status.paused) line += " paused";
  if (status.pass > 0) line += ", pass " + std::to_string(status.pass);
  line += "  space s <- -> + - q";
  return line.substr(0, width);
}

}  // namespace sinew::tools
