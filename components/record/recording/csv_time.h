// Stamps as loggers write them for people: dates and times of day. Pure.
#pragma once

#include <optional>
#include <string_view>

namespace sinew::recording {

// Seconds since 1970-01-01T00:00:00Z of a date (ISO 8601, "2026-01-31T12:00:00.25+01:00"; a blank
// for the T, a comma for the point, no zone: UTC). Nothing: it is none. To a microsecond.
std::optional<double> DateSeconds(std::string_view text);
// Seconds since midnight, "12:00:00.25".
std::optional<double> TimeOfDaySeconds(std::string_view text);

}  // namespace sinew::recording
