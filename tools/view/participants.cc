#include "tools/view/participants.h"

#include <utility>

namespace sinew::live {

Participants::Participants(std::string host, std::string own_name, double ticks_per_s)
    : host_(std::move(host)), own_name_(std::move(own_name)), load_(ticks_per_s) {}

void Participants::Hear(const ParticipantStatus& status, std::int64_t now_ns) {
  if (!own_name_.empty() && status.name == own_name_) return;
  const auto [at, is_new] = rows_.try_emplace(Key{status.name, status.host, status.process_id});
  Row& row = at->second;
  row.status = status;
  row.heard_ns = now_ns;
  if (is_new) {
    row.counted_cycles = status.cycles;
    row.counted_ns = now_ns;
  } else if (now_ns - row.counted_ns >= kCountedFor_ns) {
    const std::uint64_t more =
        status.cycles >= row.counted_cycles ? status.cycles - row.counted_cycles : 0;
    row.cycles_Hz =
        static_cast<double>(more) / (1e-9 * static_cast<double>(now_ns - row.counted_ns));
    row.counted_cycles = status.cycles;
    row.counted_ns = now_ns;
  }
}

void Participants::Forget(std::int64_t now_ns) {
  std::erase_if(rows_, [now_ns](const auto& entry) {
    return now_ns - entry.second.heard_ns > kForgotten_ns;
  });
}

void Participants::Refresh(std::int64_t now_ns) {
  Forget(now_ns);
  for (auto& [key, row] : rows_) {
    if (std::get<1>(key) != host_) continue;
    const auto pid = static_cast<pid_t>(std::get<2>(key));
    row.cpu_percent = load_.Percent(pid, ReadProcessTicks(pid), now_ns).value_or(-1.0);
  }
}

nlohmann::ordered_json Participants::Rows(std::int64_t now_ns) const {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& [key, row] : rows_) {
    const ParticipantStatus& status = row.status;
    rows.push_back(
        {{"name", status.name},
         {"kind", status.kind},
         {"state", status.state},
         {"standby", status.standby},
         {"process_id", status.process_id},
         {"host", status.host},
         {"age_s", 1e-9 * static_cast<double>(now_ns - row.heard_ns)},
         {"cycles", status.cycles},
         {"cycles_Hz", row.cycles_Hz},
         {"stale_inputs", status.stale_inputs},
         {"missed_ticks", status.missed_ticks},
         {"write_failures", status.write_failures},
         {"malformed_samples", status.malformed_samples},
         {"dropped_samples", status.dropped_samples},
         {"refused_datagrams", status.refused_datagrams},
         {"resident_MB", status.resident_MB},
         {"cpu_percent", row.cpu_percent < 0.0 ? nlohmann::ordered_json(nullptr)
                                               : nlohmann::ordered_json(row.cpu_percent)},
         {"message", status.message}});
  }
  return rows;
}

}  // namespace sinew::live
