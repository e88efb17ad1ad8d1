// component_status of a recording: the participants at a moment, as the live page had them then.
//
// Times are those of reception (log times of the file, ns): the header of component_status has the
// last tick of its participant, and none before the first. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "components/record/recording/cdr.h"
#include "tools/view/participants.h"

namespace sinew::live {

// Reads component_status by the schema of its recording.
class StatusReader {
 public:
  // Throws CdrError when the type has no name, state or cycles; other fields that it lacks, as in
  // recordings of older versions, are 0 or empty.
  explicit StatusReader(const recording::IdlType& type);

  // Throws CdrError: the payload is too short.
  ParticipantStatus Read(std::span<const std::byte> payload) const;

 private:
  using Field = std::optional<recording::CdrField>;
  recording::CdrField name_, state_, cycles_;
  Field kind_, host_, message_, standby_, process_id_, stale_inputs_, missed_ticks_;
  Field write_failures_, malformed_samples_, dropped_samples_, refused_datagrams_, resident_MB_;
};

class RecordedParticipants {
 public:
  // In order of log_ns.
  void Add(std::int64_t log_ns, ParticipantStatus status) {
    heard_.push_back({log_ns, std::move(status)});
  }
  bool empty() const { return heard_.empty(); }

  // As Participants::Rows would have been then; cpu_percent is null, since nobody recorded it.
  nlohmann::ordered_json Rows(std::int64_t log_ns) const;

 private:
  struct Heard {
    std::int64_t log_ns;
    ParticipantStatus status;
  };
  std::vector<Heard> heard_;
};

}  // namespace sinew::live
