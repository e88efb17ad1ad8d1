#include "tools/export_recording/ros2_bag.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/joints.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/recorded_time.h"
#include "tools/export_recording/ros2_messages.h"

namespace sinew::export_recording {
namespace {

using recording::CdrField;
using recording::McapMessage;

constexpr const char* kBagFile = "recording_0.mcap";  // rosbag2 numbers the files of a bag
constexpr std::size_t kFeet = 8;
constexpr auto kJoints = static_cast<std::size_t>(types::kMaxJoints);

void CheckIo(const recording::IoStatus& status) {
  if (!status.ok()) throw std::runtime_error("the bag cannot be written: " + status.message());
}

// The MCAP file and what metadata.yaml says of it.
class BagFile {
 public:
  BagFile(const std::filesystem::path& folder, const recording::McapReader& reader)
      : folder_(folder), time_(reader), sink_(folder / kBagFile, recording::Existing::kRefuse) {
    CheckIo(writer_.Open("ros2"));
  }

  void Write(const std::string& topic, const char* type, const McapMessage& original,
             const recording::Bytes& bytes) {
    const auto [entry, is_new] = topics_.try_emplace(topic);
    if (is_new) AddTopic(topic, type, &entry->second);
    CheckIo(writer_.WriteMessage(entry->second.channel, time_.Of(original),
                                 original.publish_time_ns, bytes));
    ++entry->second.messages;
  }

  std::vector<Written> Close() {
    CheckIo(writer_.Close());
    CheckIo(sink_.Close());
    config::WriteFileAtomically(folder_ / "metadata.yaml", Metadata());
    std::vector<Written> written;
    for (const auto& [name, topic] : topics_) written.push_back({name, topic.messages, 0});
    return written;
  }
  bool empty() const { return topics_.empty(); }
  const recording::RecordedTime& time() const { return time_; }

 private:
  struct Topic {
    recording::ChannelId channel{};
    const char* type = "";
    std::size_t messages = 0;
  };

  void AddTopic(const std::string& name, const char* type, Topic* topic) {
    recording::SchemaId& schema = schemas_[type];
    if (schema == recording::SchemaId{}) {
      CheckIo(writer_.AddSchema(type, "ros2msg", RosDefinition(type), &schema));
    }
    topic->type = type;
    CheckIo(
        writer_.AddChannel(schema, name, "cdr", {{"offered_qos_profiles", ""}}, &topic->channel));
  }

  // rosbag2_storage/src/rosbag2_storage/metadata_io.cpp reads it by these keys.
  std::string Metadata() const {
    const recording::McapStatistics& statistics = writer_.statistics();
    const std::string start = std::to_string(statistics.start_time_ns);
    const std::string duration = std::to_string(statistics.end_time_ns - statistics.start_time_ns);
    const std::string count = std::to_string(statistics.message_count);
    std::string text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n";
    text += "  duration:\n    nanoseconds: " + duration + "\n";
    text += "  starting_time:\n    nanoseconds_since_epoch: " + start + "\n";
    text += "  message_count: " + count + "\n  topics_with_message_count:\n";
    for (const auto& [name, topic] : topics_) {
      text += "    - topic_metadata:\n        name: " + name + "\n        type: " + topic.type +
              "\n        serialization_format: cdr\n        offered_qos_profiles: \"\"\n" +
              "      message_count: " + std::to_string(topic.messages) + "\n";
    }
    text += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - " +
            std::string(kBagFile) + "\n  files:\n    - path: " + kBagFile + "\n";
    text += "      starting_time:\n        nanoseconds_since_epoch: " + start + "\n";
    text += "      duration:\n        nanoseconds: " + duration + "\n";
    return text + "      message_count: " + count + "\n";
  }

  std::filesystem::path folder_;
  recording::RecordedTime time_;  // of the recording
  recording::FileSink sink_;
  recording::McapWriter writer_{sink_};
  std::map<std::string, recording::SchemaId> schemas_;
  std::map<std::string, Topic> topics_;
};

// The fields of one topic, by its type in the recording.
class Fields {
 public:
  explicit Fields(recording::MessageType type) : type_(std::move(type)) {}

  CdrField Get(const std::string& path) const { return CdrField(*type_.type, path); }
  std::vector<CdrField> Entries(const std::string& path, std::size_t count) const {
    std::vector<CdrField> fields;
    for (std::size_t i = 0; i < count; ++i) {
      fields.push_back(Get(path + "[" + std::to_string(i) + "]"));
    }
    return fields;
  }

 private:
  recording::MessageType type_;
};

class Translator {
 public:
  virtual ~Translator() = default;
  virtual void Translate(const McapMessage& message, BagFile* bag) = 0;
};

class JointStateTranslator : public Translator {
 public:
  JointStateTranslator(const recording::MessageType& type, const RosNames& names)
      : fields_(type), names_(names.joints), named_(!names.joints.empty()) {
    for (std::size_t i = 0; !named_ && i < kJoints; ++i) {
      names_.push_back("joint_" + std::to_string(i));
    }
  }

  void Translate(const McapMessage& message, BagFile* bag) override {
    const auto count = static_cast<std::size_t>(count_.AsInt(message.data));
    if (count > names_.size() || count > kJoints) {
      throw UsageError(std::to_string(count) + " joints, " +
                       (named_ ? "the model names " + std::to_string(names_.size())
                               : "expected at most " + std::to_string(kJoints)));
    }
    RosJointState out;
    out.header.stamp_ns = stamp_.AsInt(message.data);
    out.names.assign(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      const bool valid = valid_[i].AsInt(message.data) != 0;
      const auto value = [&](const CdrField& field) {
        return valid ? field.AsDouble(message.data) : std::numeric_limits<double>::quiet_NaN();
      };
      out.positions.push_back(value(position_[i]));
      out.velocities.push_back(value(velocity_[i]));
      out.efforts.push_back(value(torque_[i]));
    }
    bag->Write("/joint_states", kRosJointState, message, EncodeRos(out));
  }

 private:
  Fields fields_;
  std::vector<std::string> names_;
  bool named_;
  CdrField stamp_ = fields_.Get("header.stamp_ns"), count_ = fields_.Get("joint_count");
  std::vector<CdrField> position_ = fields_.Entries("position_rad", kJoints),
                        velocity_ = fields_.Entries("velocity_rad_s", kJoints),
                        torque_ = fields_.Entries("torque_Nm", kJoints),
                        valid_ = fields_.Entries("valid", kJoints);
};

class ImuTranslator : public Translator {
 public:
  ImuTranslator(const recording::MessageType& type, const RosNames& names)
      : fields_(type), frame_(names.imu_frame) {}

  void Translate(const McapMessage& message, BagFile* bag) override {
    if (valid_.AsInt(message.data) == 0) return;
    RosImu out;
    out.header = {stamp_.AsInt(message.data), frame_};
    for (std::size_t i = 0; i < 4; ++i) {  // w first here, last there
      out.orientation_xyzw[(i + 3) % 4] = orientation_[i].AsDouble(message.data);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      out.angular_velocity_rad_s[i] = rate_[i].AsDouble(message.data);
      out.acceleration_m_s2[i] = acceleration_[i].AsDouble(message.data);
    }
    bag->Write("/imu/data", kRosImu, message, EncodeRos(out));
  }

 private:
  Fields fields_;
  std::string frame_;
  CdrField stamp_ = fields_.Get("header.stamp_ns"), valid_ = fields_.Get("valid");
  std::vector<CdrField> orientation_ = fields_.Entries("orientation_wxyz", 4),
                        rate_ = fields_.Entries("angular_velocity_rad_s", 3),
                        acceleration_ = fields_.Entries("acceleration_m_s2", 3);
};

class FootForceTranslator : public Translator {
 public:
  FootForceTranslator(const recording::MessageType& type, const RosNames& names)
      : fields_(type), frames_(names.force_frames) {
    for (std::size_t i = 0; i < kFeet; ++i) {
      if (frames_[i].empty()) frames_[i] = "foot_force_" + std::to_string(i);
    }
  }

  void Translate(const McapMessage& message, BagFile* bag) override {
    for (std::size_t i = 0; i < kFeet; ++i) {
      if (valid_[i].AsInt(message.data) == 0) continue;
      RosWrench out;
      out.header = {stamp_.AsInt(message.data), frames_[i]};
      out.force_N[2] = force_[i].AsDouble(message.data);
      const std::string side = i < kFeet / 2 ? "right_" : "left_";
      bag->Write("/foot_force/" + side + std::to_string(i % (kFeet / 2)), kRosWrenchStamped,
                 message, EncodeRos(out));
    }
  }

 private:
  Fields fields_;
  std::array<std::string, kFeet> frames_;
  CdrField stamp_ = fields_.Get("header.stamp_ns");
  std::vector<CdrField> force_ = fields_.Entries("force_N", kFeet),
                        valid_ = fields_.Entries("valid", kFeet);
};

// nullptr: no topic of a bag. Throws NotReadable.
std::unique_ptr<Translator> MakeTranslator(const recording::McapReader& reader,
                                           const recording::McapChannel& channel,
                                           const RosNames& names) {
  const recording::MessageType type = recording::MessageTypeOf(reader, channel);
  if (channel.topic == "joint_state") return std::make_unique<JointStateTranslator>(type, names);
  if (channel.topic == "imu") return std::make_unique<ImuTranslator>(type, names);
  if (channel.topic == "foot_force") return std::make_unique<FootForceTranslator>(type, names);
  return nullptr;
}

RosBag Translate(const recording::RecordingPath& path, const RosNames& names,
                 const std::filesystem::path& folder) {
  recording::FileSource source(path.file);
  const recording::McapReader reader(source);
  std::map<recording::ChannelId, std::unique_ptr<Translator>> translators;
  std::set<std::string> left_out;
  for (const auto& [id, channel] : reader.channels()) {
    std::unique_ptr<Translator>& translator = translators[id];
    try {
      translator = MakeTranslator(reader, channel, names);
    } catch (const recording::NotReadable&) {  // left out as all that a bag has not
    }
    if (translator == nullptr) left_out.insert(channel.topic);
  }
  BagFile bag(folder, reader);
  recording::MessageFilter filter;
  filter.in_file_order = bag.time().in_file_order();
  filter.topics = std::set<std::string>{"joint_state", "imu", "foot_force"};
  recording::McapMessages messages = reader.Messages(filter);
  McapMessage message;
  while (messages.Next(&message)) {
    Translator* translator = translators.at(message.channel_id).get();
    if (translator != nullptr && IsInside(message, path.range)) {
      translator->Translate(message, &bag);
    }
  }
  if (bag.empty()) {
    throw UsageError("no message that a bag can have" +
                     (path.range ? " in " + path.range->text : std::string()) +
                     ", expected joint_state, imu or foot_force");
  }
  return {bag.Close(),
          {left_out.begin(), left_out.end()},
          reader.recovery() ? reader.recovery()->reason : std::string()};
}

}  // namespace

RosBag WriteRosBag(const recording::RecordingPath& path, const RosNames& names,
                   const std::filesystem::path& folder) {
  const std::string file = path.file.string() + ": ";
  try {
    return Translate(path, names, folder);
  } catch (const recording::McapError& error) {
    throw UsageError(file + error.what());
  } catch (const recording::IdlError& error) {
    throw UsageError(file + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(file + error.what());
  } catch (const UsageError& error) {
    const std::string what = error.what();
    throw UsageError(what.starts_with(file) ? what : file + what);
  }
}

}  // namespace sinew::export_recording
