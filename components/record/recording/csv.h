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
  // A column of time has dates, then its values are seconds since 1970, or times of day: seconds.
  bool has_dates = false, has_times_of_day = false;
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

}  // namespace sinew::recording
