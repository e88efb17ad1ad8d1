#include "components/record/recording/ros_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/base/types/joined.h"
#include "components/base/types/median.h"
#include "components/record/recording/cdr_walker.h"

namespace sinew::recording {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kStamp = "header/stamp";
constexpr const char* kJointState = "sensor_msgs/msg/JointState";
constexpr const char* kTypes =
    "sensor_msgs/msg/JointState, sensor_msgs/msg/Imu, geometry_msgs/msg/WrenchStamped";

// A number of a message, and how many behind it are not read: a covariance.
struct Field {
  const char* name;
  int unread = 0;
};

// Numbers behind the header, as in the published .msg files. A JointState has lists instead.
const std::map<std::string, std::vector<Field>>& Fields() {
  static const std::map<std::string, std::vector<Field>> kFields = {
      {kJointState, {}},
      {"geometry_msgs/msg/WrenchStamped",
       {{"wrench/force/x"},
        {"wrench/force/y"},
        {"wrench/force/z"},
        {"wrench/torque/x"},
        {"wrench/torque/y"},
        {"wrench/torque/z"}}},
      {"sensor_msgs/msg/Imu",
       {{"orientation/x"},
        {"orientation/y"},
        {"orientation/z"},
        {"orientation/w", 9},
        {"angular_velocity/x"},
        {"angular_velocity/y"},
        {"angular_velocity/z", 9},
        {"linear_acceleration/x"},
        {"linear_acceleration/y"},
        {"linear_acceleration/z"}}}};
  return kFields;
}

constexpr const char* kLists[] = {"position", "velocity", "effort"};  // of a JointState

IdlType Unbounded(IdlType::Kind kind) {
  IdlType type;
  type.kind = kind;
  return type;
}

std::string GetText(CdrWalker* walker) {
  static const IdlType kText = Unbounded(IdlType::Kind::kString);
  return std::string(walker->GetText(kText));
}

template <class Get>
auto GetList(CdrWalker* walker, const Get& get) {
  static const IdlType kList = Unbounded(IdlType::Kind::kSequence);
  std::vector<decltype(get())> list;
  for (std::uint32_t left = walker->GetCount(kList); left > 0; --left) list.push_back(get());
  return list;
}

}  // namespace

void RosTable::Decode(const Message& message, Topic* topic) {
  CdrWalker walker(message.payload, ReadCdrHeader(message.payload));
  const std::int64_t seconds = walker.Get<std::int32_t>();
  const std::int64_t stamp_ns = seconds * 1'000'000'000 + walker.Get<std::uint32_t>();
  GetText(&walker);  // frame_id
  const auto row = static_cast<Eigen::Index>(topic->log_ns.size());
  const auto put = [&](const std::string& column, double value) {
    if (!std::isfinite(value)) return;
    Cells& cells = topic->columns[column];
    if (!cells.rows.empty() && cells.rows.back() == row) {
      throw CdrError("'" + column + "' is there twice");
    }
    cells.rows.push_back(row);
    cells.values.push_back(value);
  };
  for (const Field& field : Fields().at(message.type)) {
    put(field.name, walker.Get<double>());
    for (int k = 0; k < field.unread; ++k) walker.Get<double>();
  }
  if (message.type == kJointState) {
    const auto names = GetList(&walker, [&] { return GetText(&walker); });
    for (const std::string& name : names) {
      if (std::find(topic->joints.begin(), topic->joints.end(), name) == topic->joints.end()) {
        topic->joints.push_back(name);
      }
    }
    for (const std::string field : kLists) {
      const auto list = GetList(&walker, [&] { return walker.Get<double>(); });
      if (!list.empty() && list.size() != names.size()) {
        throw CdrError("'" + field + "' has " + std::to_string(list.size()) +
                       " entries and 'name' " + std::to_string(names.size()));
      }
      for (std::size_t i = 0; i < list.size(); ++i) put(names[i] + "/" + field, list[i]);
    }
  }
  topic->header_ns.push_back(stamp_ns);
  topic->log_ns.push_back(message.log_time_ns);
}

void RosTable::Add(const Message& message, const std::string& file) {
  if (message.encoding != "cdr" || !Fields().contains(message.type)) {
    left_out_[message.topic] =
        message.type + (message.encoding == "cdr" ? "" : " in '" + message.encoding + "'");
    return;
  }
  Topic& topic = topics_[message.topic];
  if (topic.type.empty()) topic.type = message.type;
  try {
    if (topic.type != message.type) throw CdrError("a " + message.type);
    Decode(message, &topic);
  } catch (const CdrError& error) {
    throw std::invalid_argument(file + ": topic '" + message.topic + "', message " +
                                std::to_string(topic.log_ns.size() + 1) + ": " + error.what() +
                                ", expected a " + topic.type +
                                (topic.type == kJointState
                                     ? " with each joint once and lists of its length, or empty"
                                     : ""));
  }
}

std::vector<RosTable::Joints> RosTable::joints() const {
  std::vector<Joints> out;
  for (const auto& [name, topic] : topics_) {
    if (topic.type != kJointState) continue;
    out.push_back({name, topic.joints, {}});
    for (const std::string field : kLists) {
      bool all_have = true, any_moves = field == "position";
      for (const std::string& joint : topic.joints) {
        const auto cells = topic.columns.find(joint + "/" + field);
        all_have = cells != topic.columns.end();
        if (!all_have) break;
        any_moves = any_moves || std::ranges::any_of(cells->second.values,
                                                     [](double value) { return value != 0.0; });
      }
      if (all_have && any_moves) out.back().fields.push_back(field);
    }
  }
  return out;
}

std::size_t RosTable::MessagesOf(const std::string& column) const {
  const auto topic = TopicOf(column);
  return topic == topics_.end() ? 0 : topic->second.log_ns.size();
}

std::string RosTable::LeftOut() const {
  std::vector<std::string> topics;
  for (const auto& [topic, type] : left_out_) topics.push_back(topic + " (" + type + ")");
  return types::Joined(topics);
}

std::vector<std::string> RosTable::notes() const {
  std::vector<std::string> out;
  if (!left_out_.empty()) {
    out.push_back("left out, read are " + std::string(kTypes) + ": " + LeftOut());
  }
  for (const auto& [name, topic] : topics_) {
    if (&topic.stamps_ns() == &topic.header_ns) continue;
    out.push_back("topic '" + name + "': every header.stamp is 0, times of the log are used");
  }
  return out;
}

std::vector<std::string> RosTable::Header(const std::vector<std::string>&) const {
  std::vector<std::string> names;
  for (const auto& [name, topic] : topics_) {
    names.push_back(name + "/" + kStamp);
    for (const auto& [field, cells] : topic.columns) names.push_back(name + "/" + field);
  }
  if (names.empty()) {
    throw std::invalid_argument(
        name_ + ": has " +
        (left_out_.empty() ? "no message" : "messages of " + LeftOut() + " alone") +
        ", expected some of " + kTypes);
  }
  return names;
}

RosTable::Topics::const_iterator RosTable::TopicOf(const std::string& column) const {
  return std::find_if(topics_.begin(), topics_.end(), [&column](const auto& topic) {
    if (!column.starts_with(topic.first + "/")) return false;
    const std::string field = column.substr(topic.first.size() + 1);
    return field == kStamp || topic.second.columns.contains(field);
  });
}

const std::vector<std::int64_t>& RosTable::Topic::stamps_ns() const {
  const auto is_set = [](std::int64_t ns) { return ns != 0; };
  return std::any_of(header_ns.begin(), header_ns.end(), is_set) ? header_ns : log_ns;
}

Eigen::VectorXd RosTable::Topic::Dense(const std::string& field) const {
  const auto size = static_cast<Eigen::Index>(log_ns.size());
  if (field == kStamp) {
    const std::vector<std::int64_t>& ns = stamps_ns();
    return Eigen::Map<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>(ns.data(), size)
               .cast<double>() /
           1e9;
  }
  Eigen::VectorXd out = Eigen::VectorXd::Constant(size, kNone);
  const Cells& cells = columns.at(field);
  for (std::size_t i = 0; i < cells.rows.size(); ++i) out[cells.rows[i]] = cells.values[i];
  return out;
}

Eigen::VectorXd RosTable::Interpolated(const Topics::value_type& topic, const std::string& field,
                                       const std::vector<std::int64_t>& at_ns) const {
  const std::vector<std::int64_t>& stamps_ns = topic.second.stamps_ns();
  const Eigen::VectorXd values = topic.second.Dense(field);
  std::vector<std::int64_t> intervals_ns = {0};
  for (std::size_t k = 1; k < stamps_ns.size(); ++k) {
    intervals_ns.push_back(stamps_ns[k] - stamps_ns[k - 1]);
    if (intervals_ns.back() > 0) continue;
    throw std::invalid_argument(name_ + ": topic '" + topic.first + "', message " +
                                std::to_string(k + 1) +
                                ": its time is not after the one before, expected strictly rising "
                                "time");
  }
  const double longest_ns =
      kMostIntervals * static_cast<double>(types::UpperMedian(std::move(intervals_ns)));
  Eigen::VectorXd out = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(at_ns.size()), kNone);
  for (std::size_t row = 0; row < at_ns.size(); ++row) {
    const auto after = std::upper_bound(stamps_ns.begin(), stamps_ns.end(), at_ns[row]);
    if (after == stamps_ns.begin()) continue;
    const auto before = after - stamps_ns.begin() - 1;
    const auto since_ns = static_cast<double>(at_ns[row] - *(after - 1));
    double& value = out[static_cast<Eigen::Index>(row)];
    if (since_ns == 0.0) value = values[before];
    if (since_ns == 0.0 || after == stamps_ns.end()) continue;
    const auto gap_ns = static_cast<double>(*after - *(after - 1));
    if (gap_ns > longest_ns) continue;
    value = values[before] + (values[before + 1] - values[before]) * since_ns / gap_ns;
  }
  return out;
}

CsvTable RosTable::Read(const std::vector<std::string>& columns, Eigen::Index skipped,
                        std::size_t times) const {
  if (times == 0) {
    throw std::invalid_argument(name_ + ": messages have stamps, expected 'time: {column: TOPIC/" +
                                kStamp + ", unit: s}' in the mapping");
  }
  const auto first = TopicOf(columns.front());
  CsvTable table;
  table.name = name_;
  table.columns = columns;
  table.row = ": message ";
  std::vector<Eigen::VectorXd> all;
  for (const std::string& column : columns) {
    const auto topic = TopicOf(column);
    const std::string field = column.substr(topic->first.size() + 1);
    all.push_back(topic == first ? topic->second.Dense(field)
                                 : Interpolated(*topic, field, first->second.stamps_ns()));
  }
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = skipped; row < all.front().size(); ++row) {
    if (std::all_of(all.begin(), all.end(),
                    [row](const Eigen::VectorXd& one) { return std::isfinite(one[row]); })) {
      rows.push_back(row);
      table.lines.push_back(static_cast<int>(row + 1));
    }
  }
  if (rows.empty()) {
    throw std::invalid_argument(
        name_ + ": no message of topic '" + first->first + "'" +
        (skipped > 0 ? " behind the first " + std::to_string(skipped) : "") +
        " has a number in each of " + types::Joined(columns) + ", expected at least one");
  }
  for (const Eigen::VectorXd& one : all) table.values.emplace_back(one(rows));
  return table;
}

}  // namespace sinew::recording
