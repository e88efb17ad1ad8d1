#include "components/record/recording/run_import.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <stdexcept>

#include "components/base/types/joints.h"
#include "components/base/types/median.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/seconds.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/signal_fields.h"

namespace sinew::recording {
namespace {

constexpr std::int64_t kGapNs = 1'000'000'000;  // between two runs in one file

}  // namespace

struct RunImporter::Topic {
  Topic(const TopicSchema& schema, IoStatus* status, McapWriter* writer)
      : idl(IdlSchema::Parse(schema.idl)), type(&idl.Struct(schema.type_name)) {
    *status = AddTopic(schema, writer, &channel);
    Clear();
  }
  void Clear() { message = ZeroCdr(*type); }
  void Set(std::string_view path, double value) { Field(path).Set(message, value); }
  void SetInt(std::string_view path, std::int64_t value) { Field(path).SetInt(message, value); }
  const CdrField& Field(std::string_view path) {
    const auto found = fields.find(path);
    if (found != fields.end()) return found->second;
    return fields.emplace(std::string(path), CdrField(*type, path)).first->second;
  }

  IdlSchema idl;
  const IdlType* type;
  ChannelId channel{};
  Bytes message;
  std::map<std::string, CdrField, std::less<>> fields;
};

IoStatus AddTopic(const TopicSchema& schema, McapWriter* writer, ChannelId* id) {
  SchemaId schema_id{};
  if (IoStatus status = writer->AddSchema(schema.type_name, "omgidl", schema.idl, &schema_id);
      !status.ok()) {
    return status;
  }
  return writer->AddChannel(schema_id, schema.topic, "cdr", {{"idl_hash", schema.idl_hash}}, id);
}

std::int64_t StampFromSeconds(double time_s) { return types::ToNanoseconds(time_s).count(); }
double SecondsFromStamp(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) / 1e9; }

RunImporter::RunImporter(const FindSchema& find_schema, McapWriter& writer)
    : find_schema_(find_schema), writer_(writer) {}

std::vector<double> TimesOf(std::span<const types::Run> joints) {
  std::vector<double> times_s;
  for (const types::Run& run : joints) {
    times_s.insert(times_s.end(), run.time_s.begin(), run.time_s.end());
  }
  std::sort(times_s.begin(), times_s.end());
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  return times_s;
}

// The median interval of times that a recording can have.
static double CheckedPeriod(const std::vector<double>& times_s, const std::string& name) {
  if (times_s.size() < 2) {
    throw std::invalid_argument("run '" + name + "' has fewer than 2 samples");
  }
  if (times_s[0] < 0.0) {
    throw std::invalid_argument("run '" + name + "' has time " + std::to_string(times_s[0]) +
                                " s, expected 0 or later (the mapping's time may have an offset)");
  }
  std::vector<double> intervals_s;
  for (std::size_t row = 1; row < times_s.size(); ++row) {
    intervals_s.push_back(times_s[row] - times_s[row - 1]);
    if (StampFromSeconds(times_s[row]) <= StampFromSeconds(times_s[row - 1])) {
      throw std::invalid_argument("run '" + name + "': samples " + std::to_string(row - 1) +
                                  " and " + std::to_string(row) +
                                  " are less than a nanosecond apart");
    }
  }
  return types::UpperMedian(std::move(intervals_s));
}

static std::uint64_t SessionOf(std::span<const types::Run> joints) {
  std::uint64_t session_id = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::string hash = ContentHash(joints[j]);
    std::uint64_t number = 0;
    std::from_chars(hash.data(), hash.data() + hash.size(), number, 16);
    session_id ^= std::rotl(number, static_cast<int>(j));
  }
  return session_id;
}

IoStatus RunImporter::OpenTopics(const std::vector<std::string>& names,
                                 std::span<const types::Run> joints, std::vector<Topic*>* topics) {
  const auto session_id = static_cast<std::int64_t>(SessionOf(joints));
  for (const std::string& name : names) {
    std::shared_ptr<Topic>& topic = topics_[name];
    IoStatus status;
    if (topic == nullptr) topic = std::make_shared<Topic>(find_schema_(name), &status, &writer_);
    if (!status.ok()) return status;
    topic->Clear();
    topic->SetInt("header.session_id", session_id);
    topic->SetInt("header.origin", static_cast<std::int64_t>(types::Origin::kReplay));
    topic->SetInt("joint_count", static_cast<std::int64_t>(joints.size()));
    topics->push_back(topic.get());
  }
  return IoStatus::Ok();
}

IoStatus RunImporter::Add(std::span<const types::Run> joints,
                          const std::function<void(Eigen::Index)>& progress) {
  const types::Run& first = joints.front();
  if (joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument("run '" + first.name + "' has " + std::to_string(joints.size()) +
                                " joints, expected at most " + std::to_string(types::kMaxJoints) +
                                " (the mapping's joint_names may choose)");
  }
  const std::vector<double> times_s = TimesOf(joints);
  const double period_s = CheckedPeriod(times_s, first.name);
  std::vector<std::string> names = {"joint_state", "actuator_state"};
  if (first.Has(types::Signal::kReferencePosition)) names.emplace_back("reference");
  std::vector<Topic*> topics;
  if (IoStatus status = OpenTopics(names, joints, &topics); !status.ok()) return status;

  struct Source {
    Topic* topic;
    CdrField field;
    const Eigen::VectorXd* values;
  };
  struct Joint {
    const types::Run* run;
    std::string valid;
    std::vector<Source> sources{};
    Eigen::Index next = 0;
  };
  std::vector<Joint> all;
  std::uint32_t measured_flags = 0;
  for (const types::Run& run : joints) {
    const std::string index = std::string("[").append(std::to_string(all.size())).append("]");
    Joint& joint = all.emplace_back(Joint{&run, "valid" + index});
    for (const SignalField& field : SignalFields()) {
      if (!run.Has(field.signal)) continue;
      measured_flags |= types::SignalBit(field.signal);
      Topic* topic = topics_.find(field.topic)->second.get();
      joint.sources.push_back(
          {topic, topic->Field(std::string(field.field) + index), &run.At(field.signal)});
    }
    topics[0]->SetInt("joint_kind" + index, static_cast<std::int64_t>(run.kind));
  }
  topics[0]->SetInt("robot_state", static_cast<std::int64_t>(types::RobotState::kArmed));
  topics[0]->Set("period_s", period_s);
  topics[1]->SetInt("measured_flags", measured_flags);

  for (std::size_t row = 0; row < times_s.size(); ++row) {
    const std::int64_t stamp_ns = StampFromSeconds(times_s[row]);
    for (Joint& joint : all) {
      const bool has_sample =
          joint.next < joint.run->size() && joint.run->time_s[joint.next] == times_s[row];
      for (int k = 0; k < 2; ++k) topics[k]->SetInt(joint.valid, has_sample ? 1 : 0);
      if (!has_sample) continue;  // values stay the last known ones
      for (const Source& source : joint.sources) {
        source.field.Set(source.topic->message, (*source.values)[joint.next]);
      }
      ++joint.next;
    }
    topics[0]->Set("measured_period_s", row == 0 ? period_s : times_s[row] - times_s[row - 1]);
    if (row + 1 == times_s.size()) topics[0]->SetInt("last_tick", 1);
    for (Topic* topic : topics) {
      topic->SetInt("header.tick", static_cast<std::int64_t>(row));
      topic->SetInt("header.stamp_ns", stamp_ns);
      if (topics.size() > 2 && topic == topics[2]) {
        topic->SetInt("state_tick", static_cast<std::int64_t>(row));
      }
      IoStatus status =
          writer_.WriteMessage(topic->channel, log_offset_ns_ + stamp_ns, stamp_ns, topic->message);
      if (!status.ok()) return status;
    }
    if (progress) progress(static_cast<Eigen::Index>(row + 1));
  }
  log_offset_ns_ += StampFromSeconds(times_s.back()) + kGapNs;
  return IoStatus::Ok();
}

}  // namespace sinew::recording
