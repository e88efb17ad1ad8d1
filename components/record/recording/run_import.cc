#include "components/record/recording/run_import.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "components/base/types/seconds.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/signal_fields.h"

namespace sinew::recording {
namespace {

constexpr std::int64_t kOriginReplay = 2;       // msg::ORIGIN_REPLAY
constexpr std::int64_t kRobotArmed = 1;         // msg::ROBOT_ARMED
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

IoStatus RunImporter::Add(const types::Run& run,
                          const std::function<void(Eigen::Index)>& progress) {
  const Eigen::Index rows = run.size();
  if (rows < 2) throw std::invalid_argument("run '" + run.name + "' has fewer than 2 samples");
  std::vector<double> intervals_s;
  for (Eigen::Index row = 0; row < rows; ++row) {
    if (run.time_s[row] < 0.0) {
      throw std::invalid_argument(
          "run '" + run.name + "' has time " + std::to_string(run.time_s[row]) +
          " s, expected 0 or later (the mapping's time may have an offset)");
    }
    if (row == 0) continue;
    intervals_s.push_back(run.time_s[row] - run.time_s[row - 1]);
    if (StampFromSeconds(run.time_s[row]) <= StampFromSeconds(run.time_s[row - 1])) {
      throw std::invalid_argument("run '" + run.name + "': samples " + std::to_string(row - 1) +
                                  " and " + std::to_string(row) +
                                  " are less than a nanosecond apart");
    }
  }
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());

  const std::string hash = ContentHash(run);
  std::uint64_t session_id = 0;
  std::from_chars(hash.data(), hash.data() + hash.size(), session_id, 16);
  std::uint32_t measured_flags = 0;
  struct Source {
    Topic* topic;
    CdrField field;
    const Eigen::VectorXd* values;
  };
  std::vector<std::string> names = {"joint_state", "actuator_state"};
  if (run.Has(types::Signal::kReferencePosition)) names.emplace_back("reference");
  for (const std::string& name : names) {
    if (topics_.contains(name)) continue;
    IoStatus status;
    auto topic = std::make_shared<Topic>(find_schema_(name), &status, &writer_);
    if (!status.ok()) return status;
    topics_.emplace(name, std::move(topic));
  }
  std::vector<Topic*> topics;
  for (const std::string& name : names) {
    Topic* topic = topics_.at(name).get();
    topic->Clear();
    topic->SetInt("header.session_id", static_cast<std::int64_t>(session_id));
    topic->SetInt("header.origin", kOriginReplay);
    topic->SetInt("joint_count", 1);
    topics.push_back(topic);
  }
  std::vector<Source> sources;
  for (const SignalField& field : SignalFields()) {
    if (!run.Has(field.signal)) continue;
    measured_flags |= types::SignalBit(field.signal);
    Topic* topic = topics_.find(field.topic)->second.get();
    sources.push_back(
        {topic, topic->Field(std::string(field.field) + "[0]"), &run.At(field.signal)});
  }
  Topic& joint = *topics[0];
  joint.SetInt("robot_state", kRobotArmed);
  joint.Set("period_s", *middle);
  joint.SetInt("joint_kind[0]", run.kind == types::JointKind::kLinear ? 1 : 0);
  joint.SetInt("valid[0]", 1);
  topics[1]->SetInt("valid[0]", 1);
  topics[1]->SetInt("measured_flags", measured_flags);

  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::int64_t stamp_ns = StampFromSeconds(run.time_s[row]);
    for (const Source& source : sources)
      source.field.Set(source.topic->message, (*source.values)[row]);
    joint.Set("measured_period_s", row == 0 ? *middle : run.time_s[row] - run.time_s[row - 1]);
    if (row + 1 == rows) joint.SetInt("last_tick", 1);
    for (Topic* topic : topics) {
      topic->SetInt("header.tick", row);
      topic->SetInt("header.stamp_ns", stamp_ns);
      if (topics.size() > 2 && topic == topics[2]) topic->SetInt("state_tick", row);
      IoStatus status =
          writer_.WriteMessage(topic->channel, log_offset_ns_ + stamp_ns, stamp_ns, topic->message);
      if (!status.ok()) return status;
    }
    if (progress) progress(row + 1);
  }
  log_offset_ns_ += StampFromSeconds(run.time_s[rows - 1]) + kGapNs;
  return IoStatus::Ok();
}

}  // namespace sinew::recording
