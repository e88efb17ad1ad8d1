#include "components/base/types/clock/utc.h"

#include <ctime>

#include "components/base/types/clock/clock.h"

namespace sinew::types {

std::string UtcText(std::int64_t epoch_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t rest_ns = epoch_ns % kSecond_ns;
  const std::time_t second = epoch_ns / kSecond_ns - (rest_ns < 0 ? 1 : 0);
  std::tm utc{};
  ::gmtime_r(&second, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return std::string(text, length);
}

std::string UtcNow() { return UtcText(EpochNow_ns()); }

}  // namespace sinew::types
