#include "components/record/recording/csv_time.h"

#include <algorithm>
#include <boost/date_time/posix_time/posix_time.hpp>
#include <string>

namespace sinew::recording {

namespace {

namespace pt = boost::posix_time;

// `shape` with 0 for a digit, and any number of digits behind its last '.'.
bool HasShape(std::string_view text, std::string_view shape) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.size() < shape.size()) return false;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (shape[i] == '0' ? !is_digit(text[i]) : text[i] != shape[i]) return false;
  }
  text.remove_prefix(shape.size());
  return text.empty() || (text.size() > 1 && text.front() == '.' &&
                          std::all_of(text.begin() + 1, text.end(), is_digit));
}

double Seconds(const pt::time_duration& time) {
  return static_cast<double>(time.total_microseconds()) / 1e6;
}

std::string WithPoint(std::string_view text) {
  std::string out(text);
  std::replace(out.begin(), out.end(), ',', '.');
  return out;
}

// Takes the zone off the end of a date; its distance from UTC.
std::optional<pt::time_duration> TakeZone(std::string* date) {
  if (date->ends_with('Z')) {
    date->pop_back();
    return pt::time_duration();
  }
  const std::size_t at = date->find_first_of("+-", 10);  // behind the day
  if (at == std::string::npos) return pt::time_duration();
  std::string zone = date->substr(at + 1);
  const bool is_west = (*date)[at] == '-';
  date->resize(at);
  if (HasShape(zone, "0000")) zone.insert(2, ":");
  if (HasShape(zone, "00")) zone += ":00";
  if (zone.size() != 5 || !HasShape(zone, "00:00")) return std::nullopt;
  const pt::time_duration away = pt::duration_from_string(zone + ":00");
  return is_west ? -away : away;
}

}  // namespace

std::optional<double> TimeOfDaySeconds(std::string_view text) {
  const std::string time = WithPoint(text);
  if (!HasShape(time, "00:00:00") || time >= "24" || time[3] > '5' || time[6] > '5') {
    return std::nullopt;
  }
  return Seconds(pt::duration_from_string(time));
}

std::optional<double> DateSeconds(std::string_view text) {
  if (text.size() < 10) return std::nullopt;
  std::string date = WithPoint(text);
  const auto zone = TakeZone(&date);
  if (!zone) return std::nullopt;
  if (date.size() > 10 && date[10] == ' ') date[10] = 'T';
  if (!HasShape(date, "0000-00-00T00:00:00")) return std::nullopt;
  try {
    const pt::ptime epoch(boost::gregorian::date(1970, 1, 1));
    return Seconds(pt::from_iso_extended_string(date) - epoch - *zone);
  } catch (const std::exception&) {  // no such day, no such time
    return std::nullopt;
  }
}

}  // namespace sinew::recording
