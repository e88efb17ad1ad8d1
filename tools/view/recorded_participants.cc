#include "tools/view/recorded_participants.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace sinew::live {

namespace {

// Time that is read before the oldest status that makes a row: two more of one a second and one
// that was late, so that the row has a rate.
constexpr std::int64_t kRateNeeds_ns = 3'000'000'000;

std::optional<recording::CdrField> FieldIfThere(const recording::IdlType& type,
                                                std::string_view path) {
  if (!recording::HasField(type, path)) return std::nullopt;
  return recording::CdrField(type, path);
}

// COMPONENT_ACTIVE becomes "active".
std::string StateWord(std::string label) {
  constexpr std::string_view kPrefix = "COMPONENT_";
  if (label.starts_with(kPrefix)) label.erase(0, kPrefix.size());
  std::transform(label.begin(), label.end(), label.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return label;
}

}  // namespace

StatusReader::StatusReader(const recording::IdlType& type)
    : name_(type, "name"),
      state_(type, "state"),
      cycles_(type, "cycles"),
      kind_(FieldIfThere(type, "component_kind")),
      host_(FieldIfThere(type, "host")),
      message_(FieldIfThere(type, "message")),
      standby_(FieldIfThere(type, "standby")),
      process_id_(FieldIfThere(type, "process_id")),
      stale_inputs_(FieldIfThere(type, "stale_inputs")),
      missed_ticks_(FieldIfThere(type, "missed_ticks")),
      write_failures_(FieldIfThere(type, "write_failures")),
      malformed_samples_(FieldIfThere(type, "malformed_samples")),
      dropped_samples_(FieldIfThere(type, "dropped_samples")),
      refused_datagrams_(FieldIfThere(type, "refused_datagrams")),
      resident_MB_(FieldIfThere(type, "resident_MB")) {}

ParticipantStatus StatusReader::Read(std::span<const std::byte> payload) const {
  const auto text = [payload](const Field& field) {
    return field ? field->AsText(payload) : std::string();
  };
  const auto count = [payload](const Field& field) {
    return field ? static_cast<std::uint64_t>(field->AsInt(payload)) : 0;
  };
  ParticipantStatus status;
  status.name = name_.AsText(payload);
  status.kind = text(kind_);
  status.state = StateWord(state_.AsText(payload));
  status.host = text(host_);
  status.message = text(message_);
  status.standby = count(standby_) != 0;
  status.process_id = static_cast<std::uint32_t>(count(process_id_));
  status.cycles = static_cast<std::uint64_t>(cycles_.AsInt(payload));
  status.stale_inputs = count(stale_inputs_);
  status.missed_ticks = count(missed_ticks_);
  status.write_failures = count(write_failures_);
  status.malformed_samples = count(malformed_samples_);
  status.dropped_samples = count(dropped_samples_);
  status.refused_datagrams = count(refused_datagrams_);
  status.resident_MB = resident_MB_ ? resident_MB_->AsDouble(payload) : 0.0;
  return status;
}

nlohmann::ordered_json RecordedParticipants::Rows(std::int64_t log_ns) const {
  Participants participants;
  const std::int64_t from_ns = log_ns - Participants::kForgotten_ns - kRateNeeds_ns;
  const auto first =
      std::lower_bound(heard_.begin(), heard_.end(), from_ns,
                       [](const Heard& heard, std::int64_t value) { return heard.log_ns < value; });
  for (auto heard = first; heard != heard_.end() && heard->log_ns <= log_ns; ++heard) {
    participants.Hear(heard->status, heard->log_ns);
  }
  participants.Forget(log_ns);
  return participants.Rows(log_ns);
}

}  // namespace sinew::live
