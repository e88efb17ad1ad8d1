#include "sim/stand_ins/recorded_reference/file/recorded_file.h"

#include <sinew_idl/joint.h>
#include <sinew_idl/reference.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "components/record/logger/player/playlist.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"
#include "sim/stand_ins/recorded_reference/recorded.h"

namespace sinew::stand_ins {
namespace {

struct RecordedMotion {
  double period_s = 0.0;
  std::uint64_t session_id = 0;
  std::vector<double> tick;
  std::vector<std::vector<reference::Point>> joints;
};

void Append(const msg::Reference& message, RecordedMotion* motion) {
  if (motion->tick.empty()) {
    if (message.idle || message.joint_count == 0) return;
    motion->session_id = message.header.session_id;
    motion->joints.resize(message.joint_count);
  }
  if (message.header.session_id != motion->session_id) return;
  if (message.joint_count < motion->joints.size()) return;
  motion->tick.push_back(static_cast<double>(message.header.tick));
  for (std::size_t j = 0; j < motion->joints.size(); ++j) {
    motion->joints[j].push_back(
        {message.position_rad[j], message.velocity_rad_s[j], message.acceleration_rad_s2[j]});
  }
}

RecordedMotion ReadMotion(const std::filesystem::path& path) {
  std::vector<recording::TopicSchema> known;
  for (const node::TopicInfo& topic : node::AllTopics()) {
    known.push_back({topic.name, topic.type_name, topic.idl, topic.idl_hash});
  }
  logger::PlaylistOptions options;
  options.topics = {std::string(node::kJointState.name), std::string(node::kReference.name)};
  recording::FileSource source(path);
  const recording::McapReader reader(source);
  logger::Playlist playlist(reader, path.string(), known, options);
  RecordedMotion motion;
  logger::PlayedMessage played;
  msg::Reference reference;
  msg::JointState state;
  while (playlist.Next(&played)) {
    const auto* begin = reinterpret_cast<const std::byte*>(played.payload.data());
    const node::Bytes bytes(begin, begin + played.payload.size());
    if (played.is_state) {
      if (motion.period_s == 0.0 && node::Decode(bytes, &state)) motion.period_s = state.period_s;
    } else if (node::Decode(bytes, &reference)) {
      Append(reference, &motion);
    }
  }
  return motion;
}

}  // namespace

void Describe(config::Fields& f, RecordedReferenceFile& c) {
  f.Need("recording", c.recording, "MCAP file with a motion");
  f("soft_start_s", c.soft_start_s, config::kNotNegative, "from the measured position onto it");
  f("start_delay_s", c.start_delay_s, config::kNotNegative, "after arming");
  f.Word("start", c.start,
         {{"armed", reference::StartRule::kArmed}, {"operator", reference::StartRule::kOperator}},
         "after arming, or after the operator's start");
}

reference::RobotReferenceConfig LoadRecordedReference(const std::filesystem::path& path) {
  const config::Section file = config::Section::Load(path, kSchema);
  const auto [recording, soft_start_s, start_delay_s, start] =
      config::Read<RecordedReferenceFile>(file);
  reference::RobotReferenceConfig config{.start = start, .start_delay_s = start_delay_s};
  try {
    const RecordedMotion motion = ReadMotion(recording);
    if (motion.tick.size() < 2) {
      throw std::invalid_argument(recording.string() +
                                  ": no reference in it asks for anything, expected a motion");
    }
    if (!(motion.period_s > 0.0)) {
      throw std::invalid_argument(recording.string() +
                                  ": no joint_state, expected one for the recorded period");
    }
    std::vector<double> time_s = motion.tick;
    for (double& time : time_s) time = (time - motion.tick.front()) * motion.period_s;
    for (const std::vector<reference::Point>& points : motion.joints) {
      reference::GeneratorConfig joint;
      joint.trajectory = std::make_shared<Recorded>(time_s, points);
      joint.soft_start_s = soft_start_s;
      config.joints.push_back(joint);
    }
  } catch (const recording::McapError& error) {
    file.Fail("recording", recording.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    file.Fail("recording", error.what());
  }
  return config;
}

}  // namespace sinew::stand_ins
