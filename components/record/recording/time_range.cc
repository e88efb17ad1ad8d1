#include "components/record/recording/time_range.h"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include "components/base/types/seconds.h"
#include "components/base/types/text.h"
#include "components/record/recording/csv_map.h"

namespace sinew::recording {
namespace {

std::string Seconds(double value) { return types::Text("%.10g", value); }

[[noreturn]] void Refuse(std::string_view text, const std::string& why) {
  throw std::invalid_argument("range '" + std::string(text) + "': " + why +
                              ", expected START:END in seconds, such as 10:60, :60 or 10:");
}

double End(std::string_view digits, double if_empty, std::string_view text) {
  if (digits.empty()) return if_empty;
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() ||
      !(std::abs(value) <= types::kLongest_s)) {
    Refuse(text, "'" + std::string(digits) + "' is no time");
  }
  return value;
}

}  // namespace

bool TimeRange::Overlaps(const TimeRange& other) const {
  return start_s < other.end_s && other.start_s < end_s;
}

TimeRange ParseTimeRange(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) Refuse(text, "no ':'");
  TimeRange range;
  range.text = text;
  range.start_s = End(text.substr(0, colon), range.start_s, text);
  range.end_s = End(text.substr(colon + 1), range.end_s, text);
  if (!(range.start_s < range.end_s)) Refuse(text, "it ends before it begins");
  return range;
}

types::Run CutRun(const types::Run& run, const TimeRange& range) {
  Eigen::Index first = 0;
  while (first < run.size() && run.time_s[first] < range.start_s) ++first;
  Eigen::Index end = first;
  while (end < run.size() && run.time_s[end] < range.end_s) ++end;
  if (first == end) {
    throw std::invalid_argument(
        run.name + ": no row in the range '" + range.text +
        "' (s), the recording's clock goes from " +
        (run.size() > 0 ? Seconds(run.time_s[0]) + " to " + Seconds(run.time_s[run.size() - 1])
                        : std::string("nothing to nothing")) +
        " s");
  }
  types::Run out = run;
  out.name = run.name + "@" + range.text;
  out.time_s = run.time_s.segment(first, end - first);
  for (auto& [signal, values] : out.signals) {
    values = run.signals.at(signal).segment(first, end - first).eval();
  }
  out.content_hash = ContentHash(out);
  return out;
}

}  // namespace sinew::recording
