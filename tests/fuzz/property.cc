#include "tests/fuzz/property.h"

#include <cstdio>

namespace sinew::fuzz {

std::string Text(const can::Frame& frame) {
  char part[32];
  std::snprintf(part, sizeof part, "%X%s%s%s[%d]", frame.id, frame.extended ? "x" : "",
                frame.error ? "e" : "", frame.remote ? "#R" : "#", frame.length);
  std::string text = part;
  for (std::size_t i = 0; i < can::kMaxDataBytes; ++i) {
    std::snprintf(part, sizeof part, "%02X", frame.data[i]);
    text += part;
  }
  return text;
}

void Append(std::vector<std::uint8_t>& bytes, const can::Frame& frame) {
  bytes.push_back(static_cast<std::uint8_t>((frame.extended ? 1 : 0) | (frame.remote ? 2 : 0) |
                                            (frame.error ? 4 : 0)));
  bytes.push_back(frame.length);
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(frame.id >> (8 * i)));
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.begin() + can::kMaxDataBytes);
}

}  // namespace sinew::fuzz
