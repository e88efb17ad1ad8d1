#include "components/record/recording/body_builder.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "components/record/recording/cdr.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/run_import.h"

namespace sinew::recording {
namespace {

constexpr Eigen::Index kQuaternion = 4, kAxes = 3;

// Part of the body that a channel's messages fill.
enum class BodyTopic { kJoints, kFeet, kImu };

struct BodyDecoder {
  MessageType type;
  BodyTopic topic = BodyTopic::kJoints;
  std::string name;
  std::optional<CdrField> session_id, tick, stamp_ns;
  std::vector<CdrField> valid, values;
};

struct BodyRow {
  std::optional<std::int64_t> stamp_ns;
  std::vector<double> feet, imu;  // empty: none, or not valid
};

void AddArray(const IdlType& type, const std::string& name, int count,
              std::vector<CdrField>* fields) {
  for (int i = 0; i < count; ++i) {
    fields->emplace_back(type, std::string(name).append("[").append(std::to_string(i)).append("]"));
  }
}

BodyDecoder MakeBodyDecoder(const McapReader& reader, const McapChannel& channel, BodyTopic topic) {
  BodyDecoder out;
  out.type = MessageTypeOf(reader, channel);
  const IdlType& type = *out.type.type;
  out.topic = topic;
  out.name = channel.topic;
  out.session_id.emplace(type, "header.session_id");
  out.tick.emplace(type, "header.tick");
  if (topic == BodyTopic::kJoints) out.stamp_ns.emplace(type, "header.stamp_ns");
  if (topic == BodyTopic::kFeet) {
    AddArray(type, "valid", kFootSensors, &out.valid);
    AddArray(type, "force_N", kFootSensors, &out.values);
  }
  if (topic == BodyTopic::kImu) {
    out.valid.emplace_back(type, "valid");
    AddArray(type, "orientation_wxyz", kQuaternion, &out.values);
    AddArray(type, "angular_velocity_rad_s", kAxes, &out.values);
  }
  return out;
}

void TakeBody(const BodyDecoder& decoder, std::span<const std::byte> data, BodyRow* row) {
  if (decoder.topic == BodyTopic::kJoints) {
    if (!row->stamp_ns) row->stamp_ns = decoder.stamp_ns->AsInt(data);
    return;
  }
  std::vector<double>& values = decoder.topic == BodyTopic::kFeet ? row->feet : row->imu;
  if (!values.empty()) return;  // the first of a tick counts
  for (const CdrField& valid : decoder.valid) {
    if (valid.AsInt(data) == 0) return;
  }
  for (const CdrField& value : decoder.values) {
    values.push_back(value.AsDouble(data));
    if (!std::isfinite(values.back())) {
      values.clear();
      return;
    }
  }
}

BodyRun MakeBody(const std::map<std::uint64_t, BodyRow>& rows) {
  std::vector<const BodyRow*> used;
  for (const auto& [tick, row] : rows) {
    if (!row.stamp_ns || row.feet.empty() || row.imu.empty()) continue;
    if (!used.empty() && *row.stamp_ns <= *used.back()->stamp_ns) continue;  // no time passed
    used.push_back(&row);
  }
  BodyRun out;
  const auto size = static_cast<Eigen::Index>(used.size());
  out.time_s.resize(size);
  out.foot_force_N.resize(size, kFootSensors);
  out.orientation_wxyz.resize(size, kQuaternion);
  out.angular_velocity_rad_s.resize(size, kAxes);
  for (Eigen::Index i = 0; i < size; ++i) {
    const BodyRow& row = *used[static_cast<std::size_t>(i)];
    out.time_s[i] = SecondsFromStamp(*row.stamp_ns);
    out.foot_force_N.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.feet.data(), kFootSensors);
    out.orientation_wxyz.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.imu.data(), kQuaternion);
    out.angular_velocity_rad_s.row(i) =
        Eigen::Map<const Eigen::RowVectorXd>(row.imu.data() + kQuaternion, kAxes);
  }
  return out;
}

}  // namespace

BodyRun BodyOfRecording(const McapReader& reader, const std::string& name) {
  const std::map<std::string, BodyTopic> topics = {{"joint_state", BodyTopic::kJoints},
                                                   {"foot_force", BodyTopic::kFeet},
                                                   {"imu", BodyTopic::kImu}};
  std::map<ChannelId, BodyDecoder> decoders;
  MessageFilter filter;
  filter.topics.emplace();
  for (const auto& [topic, kind] : topics) {
    bool found = false;
    for (const auto& [id, channel] : reader.channels()) {
      if (channel.topic != topic) continue;
      found = true;
      try {
        decoders.emplace(id, MakeBodyDecoder(reader, channel, kind));
      } catch (const std::runtime_error& error) {  // IdlError, CdrError
        throw std::invalid_argument(name + ": schema of topic '" + topic + "': " + error.what());
      }
    }
    if (!found) {
      throw std::invalid_argument(name + ": no topic '" + topic +
                                  "', expected a recording of joint_state, foot_force and imu");
    }
    filter.topics->insert(topic);
  }
  McapMessages messages = reader.Messages(filter);
  std::map<std::uint64_t, BodyRow> rows;
  std::optional<std::uint64_t> session;
  McapMessage message;
  while (messages.Next(&message)) {
    const BodyDecoder& decoder = decoders.at(message.channel_id);
    try {
      const auto of = static_cast<std::uint64_t>(decoder.session_id->AsInt(message.data));
      if (session.value_or(of) != of) {
        throw std::invalid_argument(
            name + ": more than one session, expected a recording of one start of the robot");
      }
      session = of;
      const auto tick = static_cast<std::uint64_t>(decoder.tick->AsInt(message.data));
      TakeBody(decoder, message.data, &rows[tick]);
    } catch (const CdrError& error) {
      throw std::invalid_argument(name + ": message " + std::to_string(message.sequence) +
                                  " of topic '" + decoder.name + "': " + error.what());
    }
  }
  BodyRun out = MakeBody(rows);
  if (out.time_s.size() > 0) return out;
  const auto any = [&](const std::vector<double> BodyRow::*part) {
    for (const auto& [tick, row] : rows) {
      if (!(row.*part).empty()) return true;
    }
    return false;
  };
  throw std::invalid_argument(
      name +
      (!any(&BodyRow::feet)  ? ": no message of topic 'foot_force' has all sensors valid"
       : !any(&BodyRow::imu) ? ": no message of topic 'imu' is valid"
                             : ": joint_state, foot_force and imu share no tick") +
      ", expected a robot whose feet and IMU are measured");
}

}  // namespace sinew::recording
