#include "sim/render/file/recorded_poses.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/idl_schema.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::render {

namespace {

using Eigen::Isometry3d;

constexpr const char* kJoints = "joint_state";
constexpr const char* kBase = "sim_body_truth";

struct Stamped {
  std::int64_t stamp_ns = 0;
  std::vector<double> values;
};

// Some numbers of each message of a topic, of the session of the first message that is read.
class TopicReader {
 public:
  TopicReader(const recording::McapSchema& schema)
      : idl_(recording::IdlSchema::Parse(schema.data)),
        type_(idl_.Struct(schema.name)),
        session_(type_, "header.session_id"),
        stamp_(type_, "header.stamp_ns") {}

  void AddField(const std::string& path) { fields_.emplace_back(type_, path); }

  // Value of one field, whatever the session.
  std::int64_t First(const std::string& path, std::span<const std::byte> payload) const {
    return recording::CdrField(type_, path).AsInt(payload);
  }

  void Take(std::span<const std::byte> payload, std::optional<std::int64_t>* session) {
    const std::int64_t of_message = session_.AsInt(payload);
    if (!*session) *session = of_message;
    if (of_message != **session) return;
    Stamped out;
    out.stamp_ns = stamp_.AsInt(payload);
    for (const recording::CdrField& field : fields_) out.values.push_back(field.AsDouble(payload));
    messages_.push_back(std::move(out));
  }

  const std::vector<Stamped>& messages() const { return messages_; }

 private:
  recording::IdlSchema idl_;
  const recording::IdlType& type_;
  recording::CdrField session_, stamp_;
  std::vector<recording::CdrField> fields_;
  std::vector<Stamped> messages_;
};

const recording::McapChannel* FindChannel(const recording::McapReader& reader,
                                          const std::string& topic) {
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic == topic && reader.SchemaOf(channel) != nullptr) return &channel;
  }
  return nullptr;
}

recording::McapMessages MessagesOf(const recording::McapReader& reader, const std::string& topic) {
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{topic};
  return reader.Messages(filter);
}

// Indices in RobotPose::joint_rad of the joints of joint_state.
std::vector<std::size_t> JointsOfState(const arm::Chain& chain, std::size_t count,
                                       const std::string& file) {
  std::vector<std::size_t> driven, moving;
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsFree(body)) continue;
    if (arm::IsDriven(body)) driven.push_back(moving.size());
    moving.push_back(moving.size());
  }
  if (driven.size() == count) return driven;
  if (moving.size() == count) return moving;
  throw UsageError(file + ": joint_state has " + std::to_string(count) +
                   " joints, expected those of the URDF: " + std::to_string(driven.size()) +
                   " driven, " + std::to_string(moving.size()) + " that move");
}

// The newest message that is not later, or the first.
const Stamped& NewestAt(const std::vector<Stamped>& messages, std::int64_t stamp_ns) {
  const auto after = std::upper_bound(
      messages.begin(), messages.end(), stamp_ns,
      [](std::int64_t value, const Stamped& message) { return value < message.stamp_ns; });
  return after == messages.begin() ? *after : *(after - 1);
}

Isometry3d ToFrame(const std::vector<double>& v) {
  Isometry3d out = Isometry3d::Identity();
  out.translate(Eigen::Vector3d(v[0], v[1], v[2]));
  const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
  if (rotation.norm() > 0.0) out.rotate(rotation.normalized());
  return out;
}

struct Recorded {
  std::vector<Stamped> joints;
  std::vector<Stamped> base;  // position, orientation w x y z; empty: not recorded
};

Recorded ReadTopics(const recording::McapReader& reader, const std::string& file) {
  Recorded out;
  std::optional<std::int64_t> session;
  recording::McapMessage message;
  const recording::McapChannel* channel = FindChannel(reader, kJoints);
  if (channel == nullptr) throw UsageError(file + ": no joint_state");
  TopicReader joints(*reader.SchemaOf(*channel));
  recording::McapMessages joint_messages = MessagesOf(reader, kJoints);
  for (bool first = true; joint_messages.Next(&message); first = false) {
    if (first) {
      const std::int64_t count = joints.First("joint_count", message.data);
      for (std::int64_t i = 0; i < count; ++i) {
        joints.AddField("position_rad[" + std::to_string(i) + "]");
      }
    }
    joints.Take(message.data, &session);
  }
  out.joints = joints.messages();
  channel = FindChannel(reader, kBase);
  if (channel == nullptr) return out;
  TopicReader base(*reader.SchemaOf(*channel));
  for (int i = 0; i < 3; ++i) base.AddField("position_m[" + std::to_string(i) + "]");
  for (int i = 0; i < 4; ++i) base.AddField("orientation_wxyz[" + std::to_string(i) + "]");
  recording::McapMessages base_messages = MessagesOf(reader, kBase);
  while (base_messages.Next(&message)) base.Take(message.data, &session);
  out.base = base.messages();
  return out;
}

Recorded ReadFile(const std::filesystem::path& path) {
  const std::string file = path.string();
  recording::FileSource source(path);
  try {
    const recording::McapReader reader(source);
    return ReadTopics(reader, file);
  } catch (const recording::McapError& error) {
    throw UsageError(file + ": " + error.what());
  } catch (const recording::IdlError& error) {
    throw UsageError(file + ": schema: " + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(file + ": " + error.what());
  }
}

}  // namespace

bool PlaceBase(const Scene& scene, RobotPose* pose) {
  const RobotPose standing = StandingPose(scene);
  pose->world_from_base.setIdentity();
  const std::vector<Isometry3d> upright = LinkFrames(scene.chain, *pose);
  const std::vector<Isometry3d> at_rest = LinkFrames(scene.chain, standing);
  int lowest = -1, soles = 0;
  for (std::size_t i = 0; i < scene.chain.bodies.size(); ++i) {
    const std::string& link = scene.chain.bodies[i].link_name;
    if (link != "left_sole" && link != "right_sole") continue;
    ++soles;
    if (lowest < 0 || upright[i].translation().z() <
                          upright[static_cast<std::size_t>(lowest)].translation().z()) {
      lowest = static_cast<int>(i);
    }
  }
  if (soles < 2) {
    pose->world_from_base = MountedPose(scene).world_from_base;
    return false;
  }
  const auto sole = static_cast<std::size_t>(lowest);
  StandOnLink(scene.chain, scene.chain.bodies[sole].link_name, at_rest[sole], pose);
  return true;
}

RecordedPoses ReadPoses(const std::filesystem::path& recording, const Scene& scene,
                        const RecordedPosesOptions& options) {
  const Recorded recorded = ReadFile(recording);
  const std::string file = recording.string();
  if (recorded.joints.empty()) throw UsageError(file + ": joint_state has no message");
  const std::vector<std::size_t> indices =
      JointsOfState(scene.chain, recorded.joints.front().values.size(), file);
  const std::int64_t start_ns = recorded.joints.front().stamp_ns;
  const double end_s = 1e-9 * static_cast<double>(recorded.joints.back().stamp_ns - start_ns);
  RecordedPoses out;
  for (std::int64_t k = 0;; ++k) {
    TimedPose one;
    one.time_s = options.from_s + static_cast<double>(k) / options.frames_per_s;
    if (!(one.time_s <= std::min(options.to_s, end_s))) break;
    const std::int64_t stamp_ns = start_ns + std::llround(1e9 * one.time_s);
    const Stamped& joints = NewestAt(recorded.joints, stamp_ns);
    one.pose.joint_rad.assign(MovingJoints(scene.chain).size(), 0.0);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      one.pose.joint_rad[indices[i]] = joints.values[i];
    }
    if (recorded.base.empty()) {
      out.fixed_base = !PlaceBase(scene, &one.pose);
    } else {
      one.pose.world_from_base = ToFrame(NewestAt(recorded.base, stamp_ns).values);
    }
    out.poses.push_back(std::move(one));
  }
  if (out.poses.empty()) {
    throw UsageError(file + ": no state from " + std::to_string(options.from_s) +
                     " s on; it ends at " + std::to_string(end_s) + " s");
  }
  return out;
}

}  // namespace sinew::render
