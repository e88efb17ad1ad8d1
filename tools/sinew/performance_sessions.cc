#include "tools/sinew/performance_sessions.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/reference.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/robot/performance/participant/robot_meter.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"

namespace sinew::tools {
namespace {

struct RecordedTick {
  std::optional<msg::JointState> state;
  std::optional<msg::Reference> reference;
  std::optional<msg::ActuatorState> actuator;
};
struct RecordedSession {
  std::uint64_t session_id = 0;
  std::map<std::uint64_t, RecordedTick> ticks;
};

// The payload into the tick that it belongs to; another build's message is refused.
class SessionReader {
 public:
  explicit SessionReader(const std::string& file) : file_(file) {}

  std::vector<RecordedSession> Read() {
    recording::FileSource source(file_);
    const recording::McapReader reader(source);
    const std::string_view state = node::kJointState.name, reference = node::kReference.name,
                           actuator = node::kActuatorState.name;
    for (const auto& [id, channel] : reader.channels()) CheckHash(channel);
    recording::MessageFilter filter;
    filter.topics = {std::string(state), std::string(reference), std::string(actuator)};
    recording::McapMessages messages = reader.Messages(filter);
    recording::McapMessage message;
    while (messages.Next(&message)) {
      const std::string& topic = reader.channels().at(message.channel_id).topic;
      const node::Bytes bytes(message.data.begin(), message.data.end());
      if (topic == state) Add<msg::JointState>(bytes, &RecordedTick::state);
      if (topic == reference) Add<msg::Reference>(bytes, &RecordedTick::reference);
      if (topic == actuator) Add<msg::ActuatorState>(bytes, &RecordedTick::actuator);
    }
    return std::move(sessions_);
  }

 private:
  void CheckHash(const recording::McapChannel& channel) const {
    const auto hash = channel.metadata.find("idl_hash");
    const node::TopicInfo* ours = node::FindTopic(channel.topic);
    if (ours == nullptr || hash == channel.metadata.end() || hash->second == ours->idl_hash) return;
    const bool read = channel.topic == node::kJointState.name ||
                      channel.topic == node::kReference.name ||
                      channel.topic == node::kActuatorState.name;
    if (!read) return;
    throw UsageError(file_ + ": topic '" + channel.topic +
                     "' was recorded with other fields (hash " + hash->second +
                     ", this build's is " + ours->idl_hash + ")");
  }

  template <class Message>
  void Add(const node::Bytes& bytes, std::optional<Message> RecordedTick::*member) {
    Message message;
    if (!node::Decode(bytes, &message)) return;  // a lost message
    const std::uint64_t session_id = message.header.session_id;
    const std::uint64_t tick = message.header.tick;
    if (sessions_.empty() || sessions_.back().session_id != session_id) {
      for (RecordedSession& session : sessions_) {
        if (session.session_id != session_id) continue;
        session.ticks[tick].*member = std::move(message);
        return;
      }
      sessions_.push_back({session_id, {}});
    }
    sessions_.back().ticks[tick].*member = std::move(message);
  }

  std::string file_;
  std::vector<RecordedSession> sessions_;
};

MeasuredSession MeasureSession(const std::string& name, const RecordedSession& session,
                               const MeasureOptions& options) {
  performance::RobotMeter meter(performance::LoadPerformance(options.config));
  MeasuredSession measured;
  measured.name = name;
  measured.config = meter.config();
  const std::size_t joints = measured.config.joint_names.size();
  std::vector<performance::SettleTime> settle;
  std::optional<std::uint64_t> first;
  for (const auto& [tick, recorded] : session.ticks) {
    if (!recorded.state) continue;
    meter.Step({&*recorded.state, recorded.reference ? &*recorded.reference : nullptr,
                recorded.actuator ? &*recorded.actuator : nullptr});
    if (!meter.unfit().empty()) throw UsageError(name + ": " + meter.unfit());
    const double period_s = recorded.state->period_s;
    if (!first) {
      first = tick;
      if (options.event_s) {
        performance::SettleConfig config;
        config.band = options.band_rad;
        settle.assign(joints, performance::SettleTime(config, period_s));
        const double ticks = *options.event_s / period_s;
        if (!(ticks >= 0.0 && ticks <= 1e15)) {
          throw UsageError(name + ": --event " + std::to_string(*options.event_s) +
                           " s, expected a time of the session");
        }
        const auto event = static_cast<std::uint64_t>(std::llround(ticks));
        for (performance::SettleTime& joint : settle) joint.Event(tick + event);
        measured.settle.resize(joints);
      }
    }
    types::JointArray<double> rms_rad{};
    for (std::size_t j = 0; j < joints; ++j) {
      const auto& joint = meter.output().joint[j];
      rms_rad[j] =
          joint.rms_known ? joint.sliding_rms_rad : std::numeric_limits<double>::quiet_NaN();
      if (!settle.empty()) measured.settle[j] = settle[j].Step(tick, rms_rad[j]);
    }
    measured.time_s.push_back(static_cast<double>(tick - *first) * period_s);
    measured.rms_rad.push_back(rms_rad);
  }
  measured.output = meter.output();
  return measured;
}

}  // namespace

std::vector<MeasuredSession> MeasureRecordings(const std::vector<std::string>& files,
                                               const MeasureOptions& options) {
  std::vector<MeasuredSession> list;
  for (const std::string& file : files) {
    std::vector<RecordedSession> sessions;
    try {
      sessions = SessionReader(file).Read();
    } catch (const recording::McapError& error) {
      throw UsageError(file + ": " + error.what());
    }
    if (sessions.empty()) throw UsageError(file + ": no joint_state, expected a recorded session");
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      const std::string which = ", session " + std::to_string(i + 1);
      list.push_back(
          MeasureSession(sessions.size() == 1 ? file : file + which, sessions[i], options));
    }
  }
  return list;
}

}  // namespace sinew::tools
