// Date and time in UTC as text, for files and their history. Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace sinew::types {

// "2024-05-17T09:30:00Z" (ISO 8601): the second that the instant belongs to. epoch_ns: since
// 1970-01-01 00:00:00 UTC, may be negative.
std::string UtcText(std::int64_t epoch_ns);

// UtcText of the present instant.
std::string UtcNow();

}  // namespace sinew::types
