#include "components/record/recording/csv_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "components/base/types/fnv1a.h"
#include "components/base/types/joined.h"
#include "components/base/types/seconds.h"
#include "components/record/recording/signal_fields.h"

namespace sinew::recording {

double ColumnMap::ToSi(double cell) const noexcept {
  if (scale != 1.0) cell *= scale;
  if (offset != 0.0) cell += offset;
  cell = unit.ToSi(cell);
  return sign == 1.0 ? cell : sign * cell;
}

std::string ColumnMap::Names() const {
  std::string names;
  for (const Summand& summand : sum) names += (names.empty() ? "" : " + ") + summand.column;
  return names;
}

namespace {

constexpr std::string_view kJointMark = "{joint}";
constexpr double kDay_s = 86400.0;

// Text that "{joint}" stands for.
std::string JointMark(const CsvMap& map, int joint) {
  return map.joint_names.empty() ? std::to_string(joint + 1)
                                 : map.joint_names[static_cast<std::size_t>(joint)];
}

std::string ColumnName(const std::string& pattern, const std::string& joint) {
  const std::size_t at = pattern.find(kJointMark);
  if (at == std::string::npos) return pattern;
  return std::string(pattern).replace(at, kJointMark.size(), joint);
}

// The columns that it is made of, in the order in which Cell takes them.
std::vector<std::string> ColumnsOf(const ColumnMap& map, const std::string& joint) {
  std::vector<std::string> columns;
  for (const Summand& summand : map.sum) columns.push_back(ColumnName(summand.column, joint));
  for (const std::string& factor : map.times) columns.push_back(ColumnName(factor, joint));
  return columns;
}

// Places of the mapping's columns in the table; `names` grows by those that are new.
std::vector<std::size_t> FindColumns(const ColumnMap& map, const std::string& joint,
                                     const std::vector<std::string>& header,
                                     const std::string& file, std::vector<std::string>* names) {
  std::vector<std::size_t> at;
  for (const std::string& column : ColumnsOf(map, joint)) {
    if (std::find(header.begin(), header.end(), column) == header.end()) {
      throw std::invalid_argument(map.where + ": no column '" + column + "' in " + file +
                                  ", expected one of: " + types::Joined(header));
    }
    const auto known = std::find(names->begin(), names->end(), column);
    at.push_back(static_cast<std::size_t>(known - names->begin()));
    if (known == names->end()) names->push_back(column);
  }
  return at;
}

std::vector<std::string> ColumnsOf(const CsvMap& map, const std::string& joint) {
  std::vector<std::string> names;
  if (map.row_period_s == 0.0) names = ColumnsOf(map.time, joint);
  for (const SignalColumn& signal : map.signals) {
    const std::vector<std::string> more = ColumnsOf(signal.map, joint);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

double Cell(const CsvTable& table, const ColumnMap& map, const std::vector<std::size_t>& columns,
            Eigen::Index row) {
  double cell = map.constant;
  std::size_t at = 0;
  for (const Summand& summand : map.sum) {
    const double value = table.values[columns[at++]][row];
    // One column stays bit by bit what it was, also a negative 0.
    const double part = summand.factor == 1.0 ? value : summand.factor * value;
    cell = at == 1 && map.constant == 0.0 ? part : cell + part;
  }
  for (; at < columns.size(); ++at) cell *= table.values[columns[at]][row];
  return cell;
}

// Every row's time, from its columns of time.
Eigen::VectorXd Stamps(const CsvTable& table, const ColumnMap& map,
                       const std::vector<std::size_t>& columns) {
  const bool is_written = table.has_dates || table.has_times_of_day;
  if (is_written && map.unit.ToSi(map.scale) != 1.0) {
    throw std::invalid_argument(map.where + ": " + table.name +
                                " has dates or times of day in it, expected unit s and no scale");
  }
  Eigen::VectorXd time_s(table.values.front().size());
  double midnights_s = 0.0;
  for (Eigen::Index row = 0; row < time_s.size(); ++row) {
    time_s[row] = map.ToSi(Cell(table, map, columns, row)) + midnights_s;
    if (table.has_times_of_day && row > 0 && time_s[row] < time_s[row - 1] - kDay_s / 2) {
      midnights_s += kDay_s;
      time_s[row] += kDay_s;
    }
  }
  return time_s;
}

}  // namespace

types::Run ReadCsvRun(std::string_view text, const std::string& name, const CsvMap& map,
                      int joint) {
  return ReadRun(CsvText(text, name, map.format), name, map, joint);
}

types::Run ReadRun(const TableSource& source, const std::string& name, const CsvMap& map,
                   int joint) {
  if (joint < 0 || joint >= map.joints) {
    throw std::invalid_argument(name + ": joint " + std::to_string(joint) +
                                " is asked for, the mapping " + map.name +
                                " describes joints 0 to " + std::to_string(map.joints - 1));
  }
  const std::string mark = JointMark(map, joint);
  const std::vector<std::string> header = source.Header(ColumnsOf(map, mark));
  std::vector<std::string> names;
  std::vector<std::size_t> time_columns;
  const bool numbered = map.row_period_s > 0.0;
  if (!numbered) time_columns = FindColumns(map.time, mark, header, name, &names);
  const std::vector<std::string> time_names = names;
  std::vector<std::vector<std::size_t>> signal_columns;
  for (const SignalColumn& signal : map.signals) {
    signal_columns.push_back(FindColumns(signal.map, mark, header, name, &names));
  }

  if (names.empty()) {
    throw std::invalid_argument(map.name + ": key 'signals': no column of " + name +
                                " is read, expected at least one");
  }
  // Rows that are left out need not be numbers: of those of the first seconds only the stamps are
  // read.
  Eigen::Index skipped = map.skipped_rows;
  if (map.skipped_s > 0.0 && numbered) {
    const Eigen::Index first = skipped;
    while (map.row_period_s * static_cast<double>(skipped - first) < map.skipped_s) ++skipped;
  } else if (map.skipped_s > 0.0) {
    const Eigen::VectorXd time_s =
        Stamps(source.Read(time_names, skipped, time_names.size()), map.time, time_columns);
    Eigen::Index first = 0;
    while (first < time_s.size() && time_s[first] < time_s[0] + map.skipped_s) ++first;
    skipped += first;
  }
  const CsvTable table = source.Read(names, skipped, time_names.size());
  const Eigen::Index all = table.values.front().size();
  const auto line = [&](Eigen::Index row) {
    return name + table.row + std::to_string(table.lines[static_cast<std::size_t>(row)]);
  };
  Eigen::VectorXd time(all);
  if (!numbered) time = Stamps(table, map.time, time_columns);
  for (Eigen::Index row = 0; row < all; ++row) {
    if (numbered) time[row] = map.row_period_s * static_cast<double>(skipped + row);
    if (!(std::abs(time[row]) <= types::kLongest_s)) {
      throw std::invalid_argument(line(row) + ": column '" + map.time.Names() +
                                  "': a time beyond a century, expected seconds");
    }
    if (row > 0 && !(time[row] > time[row - 1])) {
      throw std::invalid_argument(
          line(row) + ": column '" + map.time.Names() + "': time " + std::to_string(time[row]) +
          " s follows " + std::to_string(time[row - 1]) + " s, expected strictly rising time");
    }
  }
  types::Run run;
  run.name = name;
  run.kind = map.kind;
  run.held = map.held;
  run.time_s = time;
  for (std::size_t i = 0; i < map.signals.size(); ++i) {
    const SignalColumn& signal = map.signals[i];
    Eigen::VectorXd values(all);
    for (Eigen::Index row = 0; row < all; ++row) {
      values[row] = signal.map.ToSi(Cell(table, signal.map, signal_columns[i], row));
      const bool flag = signal.signal == types::Signal::kValveOpen;
      if (flag && values[row] != 0.0 && values[row] != 1.0) {
        throw std::invalid_argument(line(row) + ": column '" + signal.map.Names() +
                                    "': the value is " + std::to_string(values[row]) +
                                    ", expected 0 or 1");
      }
    }
    run.signals[signal.signal] = std::move(values);
    if (signal.zero_per_recording) run.zero_unknown.insert(signal.signal);
  }
  run.content_hash = ContentHash(run);
  return run;
}

std::string ContentHash(const types::Run& run) {
  types::Fnv1a hash;
  const auto add = [&hash](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) hash.Add(static_cast<std::byte>(word >> (8 * byte)));
  };
  for (Eigen::Index row = 0; row < run.time_s.size(); ++row) {
    add(static_cast<std::uint64_t>(std::llround(run.time_s[row] * 1e9)));
  }
  for (const auto& [signal, values] : run.signals) {
    if (!OnTopics(signal)) continue;
    add(static_cast<std::uint64_t>(signal));
    for (Eigen::Index row = 0; row < values.size(); ++row)
      add(std::bit_cast<std::uint64_t>(values[row]));
  }
  return hash.Text();
}

}  // namespace sinew::recording
