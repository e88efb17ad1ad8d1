#include "tools/view/process_load.h"

#include <charconv>
#include <fstream>
#include <sstream>
#include <string>

namespace sinew::live {

namespace {

// Fields after the name, from 1 on: state is the first; utime and stime are 14 and 15 of the line,
// whose first two are pid and name.
constexpr int kUserTime = 12;
constexpr int kSystemTime = 13;

}  // namespace

std::optional<std::uint64_t> ProcessTicks(std::string_view stat) {
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string_view::npos) return std::nullopt;
  std::string_view rest = stat.substr(name_end + 1);
  std::uint64_t sum = 0;
  for (int field = 1; field <= kSystemTime; ++field) {
    while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
    const std::string_view word = rest.substr(0, rest.find(' '));
    if (field >= kUserTime) {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
      sum += value;
    }
    rest.remove_prefix(word.size());
  }
  return sum;
}

std::optional<std::uint64_t> ReadProcessTicks(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::ostringstream text;
  text << file.rdbuf();
  return ProcessTicks(text.str());
}

std::optional<double> ProcessLoad::Percent(pid_t pid, std::optional<std::uint64_t> ticks,
                                           std::int64_t now_ns) {
  if (!ticks) {
    last_.erase(pid);
    return std::nullopt;
  }
  const auto found = last_.find(pid);
  std::optional<double> percent;
  if (found != last_.end() && now_ns > found->second.now_ns && *ticks >= found->second.ticks) {
    const double busy_s = static_cast<double>(*ticks - found->second.ticks) / ticks_per_s_;
    percent = 100.0 * busy_s / (1e-9 * static_cast<double>(now_ns - found->second.now_ns));
  }
  last_[pid] = {*ticks, now_ns};
  return percent;
}

}  // namespace sinew::live
