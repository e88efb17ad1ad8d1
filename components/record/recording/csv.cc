#include "components/record/recording/csv.h"

#include <iconv.h>

#include <algorithm>
#include <bit>
#include <boost/tokenizer.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "components/base/types/joined.h"
#include "components/record/recording/csv_time.h"

namespace sinew::recording {
namespace {

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string At(const std::string& name, int line) {
  return name + ":" + std::to_string(line) + ": ";
}

// The text as UTF-8; `decoded` holds it where it was something else.
std::string_view AsUtf8(std::string_view text, const std::string& name, std::string* decoded) {
  if (text.starts_with("\xEF\xBB\xBF")) return text.substr(3);
  if (!text.starts_with("\xFF\xFE") && !text.starts_with("\xFE\xFF")) return text;
  const iconv_t converter = ::iconv_open("UTF-8", "UTF-16");  // by the byte order mark
  if (std::bit_cast<std::intptr_t>(converter) == -1) throw std::invalid_argument(name + ": UTF-16");
  decoded->resize(2 * text.size());  // two bytes become three at most
  std::string bytes(text);
  char *in = bytes.data(), *out = decoded->data();
  std::size_t in_left = bytes.size(), out_left = decoded->size();
  const std::size_t failed = ::iconv(converter, &in, &in_left, &out, &out_left);
  ::iconv_close(converter);
  if (failed == static_cast<std::size_t>(-1)) {
    throw std::invalid_argument(name + ": begins as UTF-16 and is none");
  }
  decoded->resize(decoded->size() - out_left);
  return *decoded;
}

// Lines of a text with their numbers, of which a quoted cell may have several; without blank ones.
class Lines {
 public:
  explicit Lines(std::string_view text)
      : rest_(text), end_(text.find('\n') == std::string_view::npos ? '\r' : '\n') {}

  bool Next(std::string_view* line) {
    while (!rest_.empty()) {
      number_ += breaks_ + 1;
      breaks_ = 0;
      auto end = rest_.find(end_);
      std::string_view candidate = rest_.substr(0, end);
      is_open_ = !IsComment(candidate) && IsOpen(candidate);
      while (is_open_ && end != std::string_view::npos) {
        const auto from = end + 1;
        end = rest_.find(end_, from);
        is_open_ = IsOpen(rest_.substr(from, end - from)) != is_open_;
        candidate = rest_.substr(0, end);
        ++breaks_;
      }
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      if (candidate.ends_with('\r')) candidate.remove_suffix(1);
      if (Trim(candidate).empty()) continue;
      *line = candidate;
      return true;
    }
    return false;
  }
  bool NextRow(std::string_view* line) {
    while (Next(line)) {
      if (!IsComment(*line)) return true;
    }
    return false;
  }
  int number() const { return number_; }     // of the first of this line's
  bool is_open() const { return is_open_; }  // the text has ended inside of a quoted cell

  static bool IsComment(std::string_view line) { return Trim(line).starts_with('#'); }

 private:
  static bool IsOpen(std::string_view line) {
    return line.find('"') != std::string_view::npos &&
           std::count(line.begin(), line.end(), '"') % 2 != 0;
  }

  std::string_view rest_;
  char end_;
  bool is_open_ = false;
  int number_ = 0, breaks_ = 0;
};

// Cells of one line. Quoted cells are rare in measured data: only then the tokenizer is asked.
// Throws boost::escaped_list_error.
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
  if (delimiter == ' ') line = Trim(line);
  for (;;) {
    const auto end = line.find(delimiter);
    cells->push_back(Trim(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (delimiter == ' ') line = Trim(line);
  }
}

// The names in a line, which may be a comment; none: it has no cells.
std::vector<std::string> NamesIn(std::string_view line, char delimiter) {
  if (Lines::IsComment(line)) line.remove_prefix(line.find('#') + 1);
  std::vector<std::string> unquoted;
  std::vector<std::string_view> cells;
  try {
    Split(line, delimiter, &unquoted, &cells);
  } catch (const boost::escaped_list_error&) {
    return {};
  }
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return {cells.begin(), cells.end()};
}

bool HasAll(const std::vector<std::string>& header, const std::vector<std::string>& columns) {
  return std::all_of(columns.begin(), columns.end(), [&header](const std::string& column) {
    return std::find(header.begin(), header.end(), column) != header.end();
  });
}

std::optional<double> ToNumber(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (end != cell.data() + cell.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return value;
}

// Beginning of the rows, and their columns.
struct Begin {
  Lines lines;  // the rows are the next
  char delimiter;
  std::vector<std::string> header;
  int line;  // of the header
};

constexpr std::pair<char, const char*> kDelimiters[] = {
    {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};

[[noreturn]] void FailOnDelimiter(const std::string& at, const char* word) {
  throw std::invalid_argument(
      at + "the columns stand apart by another delimiter, add 'delimiter: " + word +
      "' to the mapping");
}

// Why no line is the header that was looked for; returns where another delimiter would find none
// either.
void CheckDelimiter(Lines lines, const Begin& first, const std::string& name,
                    const std::vector<std::string>& columns) {
  if (columns.size() < 2) return;
  std::string_view line;
  while (lines.number() < kHeaderWithin && lines.Next(&line)) {
    for (const auto& [delimiter, word] : kDelimiters) {
      if (delimiter == ' ' && Lines::IsComment(line)) continue;  // prose
      if (delimiter == first.delimiter || !HasAll(NamesIn(line, delimiter), columns)) continue;
      FailOnDelimiter(At(name, lines.number()), word);
    }
  }
}

// Why a row has another number of cells than the header.
[[noreturn]] void FailOnCells(const std::string& at, std::string_view line, std::size_t cells,
                              const Begin& begin) {
  for (const auto& [delimiter, word] : kDelimiters) {
    if (delimiter == begin.delimiter || begin.header.size() < 2) continue;
    if (NamesIn(line, delimiter).size() == begin.header.size()) FailOnDelimiter(at, word);
  }
  throw std::invalid_argument(at + "the row has " + std::to_string(cells) + " cells, expected " +
                              std::to_string(begin.header.size()) + " as in the header");
}

Begin FindBegin(std::string_view text, const std::string& name,
                const std::vector<std::string>& columns, const CsvFormat& format) {
  Lines lines(text);
  char delimiter = format.delimiter;
  std::string_view line;
  Lines behind = lines;  // what Excel writes in front, and reads
  if (behind.Next(&line) && line.size() == 5 && line.starts_with("sep=")) {
    delimiter = line.back();
    lines = behind;
  }
  if (!format.header.empty()) return {lines, delimiter, format.header, 1};
  std::optional<Begin> first;
  Lines search = lines;
  while (search.number() < kHeaderWithin && search.Next(&line)) {
    const bool is_comment = Lines::IsComment(line);
    if (is_comment && columns.empty()) continue;
    Begin found{search, delimiter, NamesIn(line, delimiter), search.number()};
    if (HasAll(found.header, columns)) return found;
    if (!is_comment && !first) first = found;
  }
  if (!first) {
    throw std::invalid_argument(At(name, 1) +
                                "the file is empty, expected a header line with column names");
  }
  CheckDelimiter(lines, *first, name, columns);
  if (std::all_of(first->header.begin(), first->header.end(),
                  [](const std::string& cell) { return ToNumber(cell).has_value(); })) {
    throw std::invalid_argument(
        At(name, first->line) +
        "numbers, expected a header line with column names; where a file has none, 'header: "
        "[NAME, ...]' in the mapping names its columns");
  }
  return *first;
}

class Cells {
 public:
  explicit Cells(CsvTable* table) : table_(*table) {}

  double Number(std::string_view cell, int line, const std::string& column, bool is_time) {
    const auto value = ToNumber(cell);
    if (value && std::isfinite(*value)) {
      if (cell.find('.') != std::string_view::npos) Use('.', line, column);
      return *value;
    }
    const std::string where = At(table_.name, line) + "column '" + column + "': ";
    if (value) {
      const bool is_named = cell.find_first_of("nN") != std::string_view::npos;
      throw std::invalid_argument(where +
                                  (is_named ? "the value is " + std::string(cell) +
                                                  ", expected a finite number (leave lost rows out)"
                                            : "'" + std::string(cell) + "' does not fit a double"));
    }
    if (cell.empty()) throw std::invalid_argument(where + "the cell is empty, expected a number");
    if (const auto number = WithComma(cell)) {
      Use(',', line, column);
      return *number;
    }
    if (is_time) {
      if (const auto time_s = DateSeconds(cell)) {
        table_.has_dates = true;
        return *time_s;
      }
      if (const auto time_s = TimeOfDaySeconds(cell)) {
        table_.has_times_of_day = true;
        return *time_s;
      }
    }
    throw std::invalid_argument(where + "'" + std::string(cell) + "' is no number, expected one " +
                                (is_time ? "such as 0.25, a date such as 2026-01-31T12:00:00.25Z, "
                                           "or a time of day such as 12:00:00.25"
                                         : "such as -1.5e-3"));
  }

 private:
  static std::optional<double> WithComma(std::string_view cell) {
    const auto comma = cell.find(',');
    if (comma == std::string_view::npos || cell.find('.') != std::string_view::npos) {
      return std::nullopt;
    }
    std::string pointed(cell);
    pointed[comma] = '.';
    const auto number = ToNumber(pointed);
    return number && std::isfinite(*number) ? number : std::nullopt;
  }
  // One decimal sign in a file: of "1.234" and "0,5" nobody knows what the first is.
  void Use(char sign, int line, const std::string& column) {
    if (decimal_ == 0) decimal_ = sign;
    if (decimal_ == sign) return;
    throw std::invalid_argument(At(table_.name, line) + "column '" + column + "': '" + sign +
                                "' as decimal sign, and '" + decimal_ + "' before, expected one");
  }

  CsvTable& table_;
  char decimal_ = 0;
};

}  // namespace

std::vector<std::string> CsvHeader(std::string_view text, const std::string& name,
                                   const std::vector<std::string>& columns,
                                   const CsvFormat& format) {
  std::string decoded;
  return FindBegin(AsUtf8(text, name, &decoded), name, columns, format).header;
}

CsvTable ReadCsv(std::string_view text, const std::string& name,
                 const std::vector<std::string>& columns, const CsvFormat& format,
                 Eigen::Index skipped, std::size_t times) {
  std::string decoded;
  Begin begin = FindBegin(AsUtf8(text, name, &decoded), name, columns, format);
  Lines& lines = begin.lines;
  const std::vector<std::string>& header = begin.header;

  std::vector<std::size_t> indices;
  for (const std::string& column : columns) {
    const auto count = std::count(header.begin(), header.end(), column);
    if (count == 0) {
      throw std::invalid_argument(At(name, begin.line) + "no column '" + column +
                                  "', the file has: " + types::Joined(header));
    }
    if (count > 1) {
      throw std::invalid_argument(At(name, begin.line) + "column '" + column + "' is there " +
                                  std::to_string(count) + " times, expected once");
    }
    indices.push_back(
        static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin()));
  }

  CsvTable table;
  table.name = name;
  table.columns = columns;
  Cells numbers(&table);
  std::vector<std::vector<double>> values(columns.size());
  std::vector<std::string> unquoted;
  std::vector<std::string_view> cells;
  std::string_view line;
  Eigen::Index rows = 0;
  while (lines.NextRow(&line)) {
    if (rows++ < skipped) continue;
    if (lines.is_open()) {
      throw std::invalid_argument(At(name, lines.number()) + "a quoted cell does not end");
    }
    try {
      Split(line, begin.delimiter, &unquoted, &cells);
    } catch (const boost::escaped_list_error& error) {
      throw std::invalid_argument(At(name, lines.number()) + error.what());
    }
    if (cells.size() == header.size() + 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() != header.size()) {
      FailOnCells(At(name, lines.number()), line, cells.size(), begin);
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      values[i].push_back(numbers.Number(cells[indices[i]], lines.number(), columns[i], i < times));
    }
    table.lines.push_back(lines.number());
  }
  if (table.lines.empty() && rows > 0) {
    throw std::invalid_argument(name + ": has " + std::to_string(rows) +
                                " rows, of which the first " + std::to_string(skipped) +
                                " are left out, expected a longer recording");
  }
  if (table.lines.empty()) {
    throw std::invalid_argument(At(name, begin.line + 1) + "no row of data, expected at least one");
  }
  for (const std::vector<double>& column : values) {
    table.values.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size())));
  }
  return table;
}

}  // namespace sinew::recording
