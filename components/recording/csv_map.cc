#include "components/recording/csv_map.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "components/recording/csv.h"

namespace sinew::recording {

double ColumnMap::ToSi(double cell) const noexcept {
  if (scale != 1.0) cell *= scale;
  if (offset != 0.0) cell += offset;
  cell = unit.ToSi(cell);
  return sign == 1.0 ? cell : sign * cell;
}

identify::Run ReadCsvRun(std::string_view text, const std::string& name, const CsvMap& map) {
  const std::vector<std::string> header = CsvHeader(text, name, map.delimiter);
  std::vector<const ColumnMap*> columns = {&map.time};
  for (const SignalColumn& signal : map.signals) columns.push_back(&signal.map);
  std::vector<std::string> names;
  for (const ColumnMap* column : columns) {
    bool found = false;
    std::string list;
    for (const std::string& candidate : header) {
      found = found || candidate == column->column;
      list += (list.empty() ? "" : ", ") + candidate;
    }
    if (!found) {
      throw std::invalid_argument(column->where + ": no column '" + column->column + "' in " +
                                  name + ", expected one of: " + list);
    }
    names.push_back(column->column);
  }

  const CsvTable table = ReadCsv(text, name, names, map.delimiter);
  const Eigen::Index rows = table.values.front().size();
  identify::Run run;
  run.name = name;
  run.kind = map.kind;
  run.time_s.resize(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    run.time_s[row] = map.time.ToSi(table.values.front()[row]);
    if (row > 0 && !(run.time_s[row] > run.time_s[row - 1])) {
      throw std::invalid_argument(
          name + ":" + std::to_string(table.lines[static_cast<std::size_t>(row)]) + ": column '" +
          map.time.column + "': time " + std::to_string(run.time_s[row]) + " s follows " +
          std::to_string(run.time_s[row - 1]) + " s, expected strictly rising time");
    }
  }
  for (std::size_t i = 0; i < map.signals.size(); ++i) {
    const Eigen::VectorXd& cells = table.values[i + 1];
    Eigen::VectorXd values(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
      values[row] = map.signals[i].map.ToSi(cells[row]);
      const bool flag = map.signals[i].signal == identify::Signal::kValveOpen;
      if (flag && values[row] != 0.0 && values[row] != 1.0) {
        throw std::invalid_argument(name + ":" +
                                    std::to_string(table.lines[static_cast<std::size_t>(row)]) +
                                    ": column '" + map.signals[i].map.column + "': the value is " +
                                    std::to_string(values[row]) + ", expected 0 or 1");
      }
    }
    run.signals[map.signals[i].signal] = std::move(values);
  }
  run.content_hash = ContentHash(run);
  return run;
}

std::string ContentHash(const identify::Run& run) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      hash ^= (word >> (8 * byte)) & 0xffu;
      hash *= 0x100000001b3u;
    }
  };
  for (Eigen::Index row = 0; row < run.time_s.size(); ++row) {
    add(static_cast<std::uint64_t>(std::llround(run.time_s[row] * 1e9)));
  }
  for (const auto& [signal, values] : run.signals) {
    add(static_cast<std::uint64_t>(signal));
    for (Eigen::Index row = 0; row < values.size(); ++row)
      add(std::bit_cast<std::uint64_t>(values[row]));
  }
  constexpr std::array<char, 17> kDigits = {"0123456789abcdef"};
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[(hash >> shift) & 0xfu];
  return text;
}

}  // namespace sinew::recording
