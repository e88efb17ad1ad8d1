// CSV tables of measured data: a header line with names, then rows of numbers.
//
// What a file says of itself is understood: UTF-8, or UTF-16 with a byte order mark; LF, CRLF and
// CR; "sep=;" in front; a header behind "#" or within the first kHeaderWithin lines, which is the
// first line that has all columns asked for; "#" comment lines; quoted cells, line breaks in them
// too; an empty cell at the end of every row; '.' or ',' as decimal sign, one of them in a file;
// runs of blanks as one delimiter. In columns of time, dates (ISO 8601; without a zone UTC) and
// times of day. Only the columns asked for are read as numbers, so text columns do not hurt.
//
// Throws std::invalid_argument with "NAME:LINE: column 'x': ..., expected ..." for an empty or
// ragged table, an unknown or doubled column, a cell that is no finite number; a delimiter that
// does not fit and a missing header line are named. Set-up only: allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::recording {

inline constexpr int kHeaderWithin = 100;  // lines; headers of instruments have tens

struct CsvFormat {
  char delimiter = ',';
  std::vector<std::string> header{};  // of a file without a header line: its columns, in order
};

struct CsvTable {
  std::string name;                     // stands for the file in messages
  std::vector<std::string> columns;     // asked for, in that order
  std::vector<Eigen::VectorXd> values;  // as columns
  std::vector<int> lines;               // line number of each row, for messages about it
  std::string row = ":";                // stands between name and number of a row
  // A column of time has dates, then its values are seconds since 1970, or times of day: seconds.
  bool has_dates = false, has_times_of_day = false;
};

// Rows of named columns that a mapping (csv_map.h) is applied to: a CSV text, or a bag of ROS 2
// (ros_table.h).
class TableSource {
 public:
  virtual ~TableSource() = default;
  // Names of its columns, among them `columns` where it has these.
  virtual std::vector<std::string> Header(const std::vector<std::string>& columns) const = 0;
  // skipped, times: as in ReadCsv.
  virtual CsvTable Read(const std::vector<std::string>& columns, Eigen::Index skipped,
                        std::size_t times) const = 0;
};

// Names of the header line, which has all of `columns`, or else is the first line.
std::vector<std::string> CsvHeader(std::string_view text, const std::string& name,
                                   const std::vector<std::string>& columns = {},
                                   const CsvFormat& format = {});

// skipped: rows of data at the start that are not looked at. The first `times` of the columns are
// columns of time.
CsvTable ReadCsv(std::string_view text, const std::string& name,
                 const std::vector<std::string>& columns, const CsvFormat& format = {},
                 Eigen::Index skipped = 0, std::size_t times = 0);

class CsvText : public TableSource {
 public:
  // Keeps references.
  CsvText(std::string_view text, const std::string& name, const CsvFormat& format)
      : text_(text), name_(name), format_(format) {}
  std::vector<std::string> Header(const std::vector<std::string>& columns) const override {
    return CsvHeader(text_, name_, columns, format_);
  }
  CsvTable Read(const std::vector<std::string>& columns, Eigen::Index skipped,
                std::size_t times) const override {
    return ReadCsv(text_, name_, columns, format_, skipped, times);
  }

 private:
  std::string_view text_;
  const std::string& name_;
  const CsvFormat& format_;
};

}  // namespace sinew::recording
