// Options of a command line that are times in seconds.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "components/base/types/seconds.h"
#include "components/base/types/text.h"

namespace sinew::node {

enum class Zero { kAllowed, kRefused };

// Refuses what types::ToNanoseconds would, and negative times.
inline CLI::Validator IsTime(Zero zero) {
  const auto check = [zero](const std::string& text) -> std::string {
    double seconds = 0.0;
    const bool number = CLI::detail::lexical_cast(text, seconds);
    if (number && seconds <= types::kLongest_s &&
        (zero == Zero::kAllowed ? seconds >= 0.0 : seconds > 0.0)) {
      return "";
    }
    return "'" + text + "' s" +
           types::Text(", expected %s 0 to %.0f (a century)",
                       zero == Zero::kAllowed ? "from" : "above", types::kLongest_s);
  };
  return CLI::Validator(check, zero == Zero::kAllowed ? "NONNEGATIVE" : "POSITIVE");
}

}  // namespace sinew::node
