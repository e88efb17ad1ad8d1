// Seconds, as they are written in a configuration or on a command line, to whole nanoseconds; as
// text.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace sinew::types {

// A century. Added to a clock that counts from 1970 it stays below half of the 292 years that 64
// bits hold, so that sums of two times do not overflow either.
inline constexpr double kLongest_s = 100.0 * 365.25 * 86400.0;

// Rounded to the nearest. Throws std::invalid_argument for what is not finite or longer than
// kLongest_s in either direction.
inline std::chrono::nanoseconds ToNanoseconds(double seconds) {
  if (!(std::abs(seconds) <= kLongest_s)) {
    char text[96];
    std::snprintf(text, sizeof text, "a time of %g s, expected at most %.0f s (a century)", seconds,
                  kLongest_s);
    throw std::invalid_argument(text);
  }
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

// To a millisecond, without zeros at the end: stamps since 1970 keep all of theirs.
inline std::string SecondsText(double seconds) {
  char text[340];
  std::string out(text,
                  static_cast<std::size_t>(std::snprintf(text, sizeof text, "%.3f", seconds)));
  if (std::isfinite(seconds)) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.ends_with('.')) out.pop_back();
  }
  return out;
}

}  // namespace sinew::types
