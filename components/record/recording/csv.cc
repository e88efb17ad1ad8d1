#include "components/record/recording/csv.h"

#include <algorithm>
#include <boost/tokenizer.hpp>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sinew::recording {
namespace {

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Lines of a text with their numbers; skips blank lines and comments.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }
  bool Next(std::string_view* line) {
    while (!rest_.empty()) {
      const auto end = rest_.find('\n');
      std::string_view candidate = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (candidate.ends_with('\r')) candidate.remove_suffix(1);
      const std::string_view trimmed = Trim(candidate);
      if (trimmed.empty() || trimmed.front() == '#') continue;
      *line = candidate;
      return true;
    }
    return false;
  }
  int number() const { return number_; }

 private:
  std::string_view rest_;
  int number_ = 0;
};

// Cells of one line. Quoted cells are rare in measured data: only then the tokenizer is asked.
void Split(std::string_view line, char delimiter, std::vector<std::string>* unquoted,
           std::vector<std::string_view>* cells) {
  cells->clear();
  if (line.find('"') != std::string_view::npos) {
    unquoted->clear();
    // No backslash escapes in CSV: a character that no text has stands for it.
    const boost::escaped_list_separator<char> separator('\x01', delimiter, '"');
    const std::string text(line);
    const boost::tokenizer<boost::escaped_list_separator<char>> tokens(text, separator);
    unquoted->assign(tokens.begin(), tokens.end());
    for (const std::string& cell : *unquoted) cells->push_back(Trim(cell));
    return;
  }
  for (;;) {
    const auto end = line.find(delimiter);
    cells->push_back(Trim(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

std::string At(const std::string& name, int line) {
  return name + ":" + std::to_string(line) + ": ";
}

std::string List(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

std::vector<std::string> Header(Lines* lines, const std::string& name, char delimiter) {
  std::string_view line;
  if (!lines->Next(&line)) {
    throw std::invalid_argument(At(name, 1) +
                                "the file is empty, expected a header line with column names");
  }
  std::vector<std::string> unquoted;
  std::vector<std::string_view> cells;
  Split(line, delimiter, &unquoted, &cells);
  return {cells.begin(), cells.end()};
}

double Number(std::string_view cell, const std::string& name, int line, const std::string& column) {
  const std::string where = At(name, line) + "column '" + column + "': ";
  if (cell.empty()) throw std::invalid_argument(where + "the cell is empty, expected a number");
  const std::string_view digits = cell.front() == '+' ? cell.substr(1) : cell;
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    throw std::invalid_argument(where + "'" + std::string(cell) + "' does not fit a double");
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    throw std::invalid_argument(where + "'" + std::string(cell) +
                                "' is no number, expected one such as -1.5e-3");
  }
  if (!std::isfinite(value)) {
    throw std::invalid_argument(where + "the value is " + std::string(cell) +
                                ", expected a finite number (leave lost rows out)");
  }
  return value;
}

}  // namespace

std::vector<std::string> CsvHeader(std::string_view text, const std::string& name, char delimiter) {
  Lines lines(text);
  return Header(&lines, name, delimiter);
}

CsvTable ReadCsv(std::string_view text, const std::string& name,
                 const std::vector<std::string>& columns, char delimiter, Eigen::Index skipped) {
  Lines lines(text);
  const std::vector<std::string> header = Header(&lines, name, delimiter);
  const int header_line = lines.number();

  std::vector<std::size_t> indices;
  for (const std::string& column : columns) {
    const auto count = std::count(header.begin(), header.end(), column);
    if (count == 0) {
      throw std::invalid_argument(At(name, header_line) + "no column '" + column +
                                  "', the file has: " + List(header));
    }
    if (count > 1) {
      throw std::invalid_argument(At(name, header_line) + "column '" + column + "' is there " +
                                  std::to_string(count) + " times, expected once");
    }
    indices.push_back(
        static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin()));
  }

  CsvTable table{name, columns, {}, {}};
  std::vector<std::vector<double>> values(columns.size());
  std::vector<std::string> unquoted;
  std::vector<std::string_view> cells;
  std::string_view line;
  Eigen::Index rows = 0;
  while (lines.Next(&line)) {
    if (rows++ < skipped) continue;
    try {
      Split(line, delimiter, &unquoted, &cells);
    } catch (const boost::escaped_list_error&) {
      throw std::invalid_argument(At(name, lines.number()) + "a quoted cell does not end");
    }
    if (cells.size() != header.size()) {
      throw std::invalid_argument(At(name, lines.number()) + "the row has " +
                                  std::to_string(cells.size()) + " cells, expected " +
                                  std::to_string(header.size()) + " as in the header");
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      values[i].push_back(Number(cells[indices[i]], name, lines.number(), columns[i]));
    }
    table.lines.push_back(lines.number());
  }
  if (table.lines.empty() && rows > 0) {
    throw std::invalid_argument(name + ": has " + std::to_string(rows) +
                                " rows, of which the first " + std::to_string(skipped) +
                                " are left out, expected a longer recording");
  }
  if (table.lines.empty()) {
    throw std::invalid_argument(At(name, header_line + 1) +
                                "no row of data, expected at least one");
  }
  for (const std::vector<double>& column : values) {
    table.values.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size())));
  }
  return table;
}

}  // namespace sinew::recording
