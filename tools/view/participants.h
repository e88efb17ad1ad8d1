// The participants that are there, from their component_status. Not synchronized.
#pragma once

#include <sinew_idl/status.h>

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "tools/view/process_load.h"

namespace sinew::live {

class Participants {
 public:
  // Rows that were not heard for as long are left out: ten times what a live participant needs.
  static constexpr std::int64_t kForgotten_ns = 10'000'000'000;

  // host: of this process; the load of its processes is read. own_name: is no row.
  Participants(std::string host, std::string own_name, double ticks_per_s);

  void Hear(const msg::ComponentStatus& status, std::int64_t now_ns);
  // Reads the loads and drops rows that are forgotten; about once a second.
  void Refresh(std::int64_t now_ns);

  // An array, a row a process: name, kind, state, standby, process_id, host, age_s, cycles,
  // cycles_Hz, stale_inputs, missed_ticks, write_failures, malformed_samples, dropped_samples,
  // resident_MB, cpu_percent (null: not known), message.
  nlohmann::ordered_json Rows(std::int64_t now_ns) const;
  std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    msg::ComponentStatus status;
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
