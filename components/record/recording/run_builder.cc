#include "components/record/recording/run_builder.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include "components/record/recording/cdr.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/run_import.h"
#include "components/record/recording/session_clock.h"
#include "components/record/recording/signal_fields.h"

namespace sinew::recording {
namespace {

using types::Signal;

constexpr std::uint32_t kWithoutActuator =
    types::SignalBits({Signal::kPosition, Signal::kVelocity, Signal::kTorque});
constexpr auto kPositionIndex = static_cast<std::size_t>(Signal::kPosition);
constexpr auto kReferenceIndex = static_cast<std::size_t>(Signal::kReferencePosition);
constexpr int kHeldTicks = 2;  // a lost set point is the last one for so long

struct Row {
  std::int64_t stamp_ns = 0;
  bool joint = false;
  bool actuator = false;
  bool reference = false;
  bool asked = false;  // the reference asks for something
  bool valid = true;
  std::array<double, types::kSignalCount> values{};
};

struct Session {
  std::map<std::uint64_t, Row> rows;
  std::uint32_t measured_flags = ~std::uint32_t{0};
  bool linear = false;
  bool any_actuator = false;
};

// Fields that are read of a channel's messages.
struct Decoder {
  MessageType type;
  std::string topic;
  std::optional<CdrField> session_id, tick, stamp_ns, joint_count, valid, measured_flags,
      joint_kind;
  std::vector<std::pair<std::size_t, CdrField>> signals;
};

std::unique_ptr<Decoder> MakeDecoder(const McapReader& reader, const McapChannel& channel,
                                     int joint) {
  auto decoder = std::make_unique<Decoder>();
  decoder->topic = channel.topic;
  decoder->type = MessageTypeOf(reader, channel);
  const IdlType& type = *decoder->type.type;
  const std::string index = std::string("[").append(std::to_string(joint)).append("]");
  decoder->session_id.emplace(type, "header.session_id");
  decoder->tick.emplace(type, "header.tick");
  decoder->stamp_ns.emplace(type, "header.stamp_ns");
  decoder->joint_count.emplace(type, "joint_count");
  if (channel.topic != "reference") decoder->valid.emplace(type, "valid" + index);
  if (channel.topic == "actuator_state") decoder->measured_flags.emplace(type, "measured_flags");
  if (channel.topic == "joint_state") decoder->joint_kind.emplace(type, "joint_kind" + index);
  for (const SignalField& field : SignalFields()) {
    if (field.topic != channel.topic) continue;
    decoder->signals.emplace_back(static_cast<std::size_t>(field.signal),
                                  CdrField(type, std::string(field.field) + index));
  }
  return decoder;
}

void TakeMessage(const Decoder& decoder, std::span<const std::byte> data, int joint,
                 const std::string& name, std::map<std::uint64_t, Session>* sessions,
                 std::vector<std::uint64_t>* order) {
  const auto session_id = static_cast<std::uint64_t>(decoder.session_id->AsInt(data));
  const auto tick = static_cast<std::uint64_t>(decoder.tick->AsInt(data));
  const std::int64_t joint_count = decoder.joint_count->AsInt(data);
  const bool idle = decoder.topic == "reference" && joint_count == 0;
  if (joint >= joint_count && !idle) {
    throw std::invalid_argument(name + ": joint " + std::to_string(joint) +
                                " is asked for, topic '" + decoder.topic + "' has joints 0 to " +
                                std::to_string(joint_count - 1));
  }
  auto [session, added] = sessions->try_emplace(session_id);
  if (added) order->push_back(session_id);
  Row& row = session->second.rows[tick];
  bool& here = decoder.measured_flags ? row.actuator
               : decoder.joint_kind   ? row.joint
                                      : row.reference;
  if (here) return;  // the first of a tick counts
  here = true;
  if (idle) return;
  if (!decoder.measured_flags && !decoder.joint_kind) row.asked = true;
  if (decoder.joint_kind) {
    row.stamp_ns = decoder.stamp_ns->AsInt(data);
    session->second.linear = decoder.joint_kind->AsInt(data) == 1;
  }
  if (decoder.measured_flags) {
    session->second.measured_flags &=
        static_cast<std::uint32_t>(decoder.measured_flags->AsInt(data));
    session->second.any_actuator = true;
  }
  if (decoder.valid) row.valid = row.valid && decoder.valid->AsInt(data) != 0;
  for (const auto& [signal, field] : decoder.signals) {
    row.values[signal] = field.AsDouble(data);
    if (!std::isfinite(row.values[signal])) row.valid = false;
  }
}

std::optional<types::Run> MakeRun(Session* session) {
  std::vector<Row*> rows;
  SessionClock clock;
  const Row* reference = nullptr;
  int since_reference = 0;
  bool has_reference = true;
  for (auto& [tick, row] : session->rows) {
    if (row.reference) {
      reference = &row;
      since_reference = 0;
    } else {
      ++since_reference;
    }
    if (!row.joint || !row.valid || (session->any_actuator && !row.actuator)) continue;
    row.stamp_ns = clock.Take(tick, row.stamp_ns);
    if (!rows.empty() && row.stamp_ns <= rows.back()->stamp_ns) continue;  // no time passed
    if (reference == nullptr || since_reference > kHeldTicks) has_reference = false;
    if (reference != nullptr) {
      row.values[kReferenceIndex] =
          reference->asked ? reference->values[kReferenceIndex] : row.values[kPositionIndex];
    }
    rows.push_back(&row);
  }
  if (rows.size() < 2) return std::nullopt;

  types::Run run;
  run.clock_set_back_s = SecondsFromStamp(clock.set_back_ns());
  run.kind = session->linear ? types::JointKind::kPrismatic : types::JointKind::kRevolute;
  const auto size = static_cast<Eigen::Index>(rows.size());
  run.time_s.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    run.time_s[i] = SecondsFromStamp(rows[static_cast<std::size_t>(i)]->stamp_ns);
  }
  std::uint32_t flags = session->any_actuator ? session->measured_flags : kWithoutActuator;
  flags &= ~types::SignalBit(Signal::kReferencePosition);
  if (has_reference) flags |= types::SignalBit(Signal::kReferencePosition);
  for (const Signal signal : types::AllSignals()) {
    if (!OnTopics(signal) || (flags & types::SignalBit(signal)) == 0) continue;
    Eigen::VectorXd values(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      values[i] = rows[static_cast<std::size_t>(i)]->values[static_cast<std::size_t>(signal)];
    }
    run.signals[signal] = std::move(values);
  }
  return run;
}

}  // namespace

std::vector<types::Run> RunsOfRecording(const McapReader& reader, const std::string& name,
                                        int joint,
                                        const std::function<void(std::uint64_t)>& progress) {
  if (joint < 0)
    throw std::invalid_argument("joint " + std::to_string(joint) + ", expected 0 or more");
  std::map<ChannelId, std::unique_ptr<Decoder>> decoders;
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic != "joint_state" && channel.topic != "actuator_state" &&
        channel.topic != "reference") {
      continue;
    }
    try {
      decoders[id] = MakeDecoder(reader, channel, joint);
    } catch (const std::runtime_error& error) {  // IdlError, CdrError
      throw std::invalid_argument(name + ": schema of topic '" + channel.topic +
                                  "': " + error.what());
    }
  }
  MessageFilter filter;
  filter.topics = std::set<std::string>{"joint_state", "actuator_state", "reference"};
  McapMessages messages = reader.Messages(filter);
  std::map<std::uint64_t, Session> sessions;
  std::vector<std::uint64_t> order;
  McapMessage message;
  std::uint64_t count = 0;
  while (messages.Next(&message)) {
    const Decoder& decoder = *decoders.at(message.channel_id);
    try {
      TakeMessage(decoder, message.data, joint, name, &sessions, &order);
    } catch (const CdrError& error) {
      throw std::invalid_argument(name + ": message " + std::to_string(message.sequence) +
                                  " of topic '" + decoder.topic + "': " + error.what());
    }
    if (progress) progress(++count);
  }

  std::vector<types::Run> runs;
  for (const std::uint64_t id : order) {
    std::optional<types::Run> run = MakeRun(&sessions.at(id));
    if (!run) continue;
    run->content_hash = ContentHash(*run);
    runs.push_back(std::move(*run));
  }
  if (runs.empty()) {
    throw std::invalid_argument(name + ": no session has two valid samples of joint " +
                                std::to_string(joint) +
                                " on joint_state, expected a recording of a moving robot");
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].name = runs.size() == 1 ? name : name + "#" + std::to_string(i + 1);
  }
  return runs;
}

}  // namespace sinew::recording
