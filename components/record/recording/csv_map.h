// Mapping of the columns of a CSV file to signals, in which unit and with which sign.
//
//     value_SI = sign * unit(scale * cell + offset)
//     cell = (sum of factor * column + constant) * product of other columns
//
// with constant, scale and offset in the column's unit. Most cells are one column; a sum is a loss
// between two sensors, a product a duty of a bus voltage. "{joint}" in a column's name is the
// joint's number from 1 on, or its name, so that one mapping reads an arm. Reading of the YAML
// file: file/csv_map_file.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/joint_kind.h"
#include "components/base/types/run.h"
#include "components/record/recording/csv.h"
#include "components/record/recording/units.h"

namespace sinew::recording {

struct Summand {
  std::string column;
  double factor = 1.0;
};

struct ColumnMap {
  std::vector<Summand> sum;        // empty: the constant alone
  double constant = 0.0;           // added to the sum
  std::vector<std::string> times;  // columns that the cell is multiplied by
  Unit unit;
  double scale = 1.0;
  double offset = 0.0;
  double sign = 1.0;
  std::string where;  // "map.yaml:7: key 'signals.position.column'", for messages

  // The column, or all of a sum with " + " between them: for messages.
  std::string Names() const;
  double ToSi(double cell) const noexcept;
};

struct SignalColumn {
  types::Signal signal{};
  ColumnMap map;
  bool zero_per_recording = false;  // types::Run::zero_unknown
};

struct CsvMap {
  std::string name;  // of the mapping file
  types::JointKind kind = types::JointKind::kRevolute;
  CsvFormat format;
  int joints = 1;                        // that "{joint}" counts
  std::vector<std::string> joint_names;  // that "{joint}" stands for; empty: numbers
  // Rows at the start of a file that are left out, and those earlier than this after the first.
  Eigen::Index skipped_rows = 0;
  double skipped_s = 0.0;
  bool held = false;  // every row is a position held (types::Run)
  // > 0: rows have no stamps, they are this long apart, from 0 on; `time` is not read.
  double row_period_s = 0.0;
  ColumnMap time;
  std::vector<SignalColumn> signals;
};

// The run of one joint (from 0 on) that a table or a CSV text holds. Time must rise strictly; times
// of day go on past midnight. Throws std::invalid_argument with one line that names file, line and
// column.
types::Run ReadRun(const TableSource& source, const std::string& name, const CsvMap& map,
                   int joint = 0);
types::Run ReadCsvRun(std::string_view text, const std::string& name, const CsvMap& map,
                      int joint = 0);

// Names the samples of a run: 16 hex digits of FNV-1a over time in whole nanoseconds and the bits
// of every signal that topics carry, in the order of the signals. Equal for a CSV file and a
// recording made of it.
std::string ContentHash(const types::Run& run);

}  // namespace sinew::recording
