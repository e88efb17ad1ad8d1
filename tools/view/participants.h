// The participants that are there, from their component_status: of a domain, or at a moment of a
// recording.
//
// Times are those of reception, on any one clock. Not synchronized.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "tools/view/process_load.h"

namespace sinew::live {

// A participant's status (idl/status.idl), as far as it is shown.
struct ParticipantStatus {
  std::string name, kind, state, host, message;  // state: "active"
  bool standby = false;
  std::uint32_t process_id = 0;
  std::uint64_t cycles = 0, stale_inputs = 0, missed_ticks = 0;
  std::uint64_t write_failures = 0, malformed_samples = 0, dropped_samples = 0;
  std::uint64_t refused_datagrams = 0;
  double resident_MB = 0.0;
};

class Participants {
 public:
  // Rows that were not heard for as long are left out: ten times what a live participant needs.
  static constexpr std::int64_t kForgotten_ns = 10'000'000'000;
  // A rate of cycles is of at least this time, since a status on change may follow at once.
  static constexpr std::int64_t kCountedFor_ns = 900'000'000;

  // Without loads of processes.
  Participants() : Participants({}, {}, 1.0) {}
  // host: of this process; the load of its processes is read. own_name: is no row.
  Participants(std::string host, std::string own_name, double ticks_per_s);

  void Hear(const ParticipantStatus& status, std::int64_t now_ns);
  // Drops the rows that were not heard for kForgotten_ns.
  void Forget(std::int64_t now_ns);
  // Forgets, and reads the loads; about once a second.
  void Refresh(std::int64_t now_ns);

  // An array, a row a process: name, kind, state, standby, process_id, host, age_s, cycles,
  // cycles_Hz, stale_inputs, missed_ticks, write_failures, malformed_samples, dropped_samples,
  // refused_datagrams, resident_MB, cpu_percent (null: not known), message.
  nlohmann::ordered_json Rows(std::int64_t now_ns) const;
  std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    ParticipantStatus status;
    std::int64_t heard_ns = 0;
    double cycles_Hz = 0.0;
    std::uint64_t counted_cycles = 0;  // at counted_ns
    std::int64_t counted_ns = 0;
    double cpu_percent = -1.0;  // below 0: not known
  };
  // A name may be taken twice, so a row is a process.
  using Key = std::tuple<std::string, std::string, std::uint32_t>;

  const std::string host_, own_name_;
  ProcessLoad load_;
  std::map<Key, Row> rows_;
};

}  // namespace sinew::live
