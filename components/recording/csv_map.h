// Which column of a CSV file is which signal, in which unit and with which sign.
//
//     value_SI = sign * unit(scale * cell + offset)
//
// with scale and offset in the column's unit. Reading of the YAML file: file/csv_map_file.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "components/effects/effect.h"
#include "components/identify/run.h"
#include "components/recording/units.h"

namespace sinew::recording {

struct ColumnMap {
  std::string column;
  Unit unit;
  double scale = 1.0;
  double offset = 0.0;
  double sign = 1.0;
  std::string where;  // "map.yaml:7: key 'signals.position.column'", for messages

  double ToSi(double cell) const noexcept;
};

struct SignalColumn {
  identify::Signal signal{};
  ColumnMap map;
};

struct CsvMap {
  std::string name;  // of the mapping file
  effects::JointKind kind = effects::JointKind::kRotary;
  char delimiter = ',';
  ColumnMap time;
  std::vector<SignalColumn> signals;
};

// The run that a CSV text holds. Time must rise strictly. Throws std::invalid_argument with one
// line that names file, line and column.
identify::Run ReadCsvRun(std::string_view text, const std::string& name, const CsvMap& map);

// Names the samples of a run: 16 hex digits of FNV-1a over time in whole nanoseconds and the bits
// of every signal, in the order of the signals. Equal for a CSV file and a recording made of it.
std::string ContentHash(const identify::Run& run);

}  // namespace sinew::recording
