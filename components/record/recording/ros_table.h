// Messages of a bag of ROS 2 as rows of named columns: TOPIC/FIELD/FIELD, such as
// /imu/data/angular_velocity/x, and TOPIC/JOINT/position, velocity, effort of a JointState, in
// whatever order its messages name the joints. TOPIC/header/stamp is the time in seconds; where all
// stamps of a topic are 0, that of its log.
//
// A row is a message of the first column's topic, which is that of the time. Columns of other
// topics are interpolated at its stamp, on the line between their two messages about it. A message
// without a finite number in each column asked for is no row, nor is one at whose stamp the two
// messages of another topic are further apart than kMostIntervals of its median interval. Pure;
// allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "components/record/recording/csv.h"

namespace sinew::recording {

inline constexpr double kMostIntervals = 3.0;  // two lost messages between two that are there

class RosTable : public TableSource {
 public:
  // name: stands for the bag in messages.
  explicit RosTable(std::string name) : name_(std::move(name)) {}

  struct Message {
    std::string topic, type;  // sensor_msgs/msg/JointState
    std::string encoding;     // cdr
    std::int64_t log_time_ns = 0;
    std::span<const std::byte> payload;
  };
  // In the order of the bag; what is no JointState, Imu or WrenchStamped in CDR is left out. Throws
  // std::invalid_argument naming file, topic and message.
  void Add(const Message& message, const std::string& file);

  struct Joints {
    std::string topic;
    std::vector<std::string> names;  // in the order of their first message
    // position, velocity, effort: those that all of them have. Velocities or efforts that are 0
    // throughout were not measured: many drivers fill the lists.
    std::vector<std::string> fields;
  };
  std::vector<Joints> joints() const;  // of each topic of the type JointState
  // The number of messages of the column's topic; 0: there is no such column.
  std::size_t MessagesOf(const std::string& column) const;
  // Notes on what is not as the bag says: topics that are left out, stamps that are 0.
  std::vector<std::string> notes() const;

  // Throw std::invalid_argument: no column at all, a mapping without stamps, no row, stamps of a
  // topic to interpolate that do not rise.
  std::vector<std::string> Header(const std::vector<std::string>& columns) const override;
  CsvTable Read(const std::vector<std::string>& columns, Eigen::Index skipped,
                std::size_t times) const override;

 private:
  struct Cells {
    std::vector<Eigen::Index> rows;  // messages that have one
    std::vector<double> values;
  };
  struct Topic {
    std::string type;
    std::vector<std::int64_t> header_ns, log_ns;
    std::vector<std::string> joints;
    std::map<std::string, Cells> columns;

    const std::vector<std::int64_t>& stamps_ns() const;
    // One value for each message, NaN where it has none.
    Eigen::VectorXd Dense(const std::string& field) const;
  };
  using Topics = std::map<std::string, Topic>;

  static void Decode(const Message& message, Topic* topic);
  std::string LeftOut() const;
  // The topic of a column; its field is what follows the topic's name and a slash.
  Topics::const_iterator TopicOf(const std::string& column) const;
  Eigen::VectorXd Interpolated(const Topics::value_type& topic, const std::string& field,
                               const std::vector<std::int64_t>& at_ns) const;

  std::string name_;
  Topics topics_;
  std::map<std::string, std::string> left_out_;  // topic, type
};

}  // namespace sinew::recording
