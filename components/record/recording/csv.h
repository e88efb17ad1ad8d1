// CSV tables of measured data: a header line with names, then rows of numbers.
//
// Comma (or another delimiter), '.' as decimal sign, optional quotes, "#" comment lines, CRLF and a
// byte order mark are understood. Only the columns asked for are read as numbers, so text columns
// do not hurt. Throws std::invalid_argument with "NAME:LINE: column 'x': ..., expected ..." for an
// empty or ragged table, an unknown or doubled column, a cell that is no finite number. Set-up
// only: allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::recording {

struct CsvTable {
  std::string name;                     // stands for the file in messages
  std::vector<std::string> columns;     // asked for, in that order
  std::vector<Eigen::VectorXd> values;  // as columns
  std::vector<int> lines;               // line number of each row, for messages about it
};

// Names of the header line.
std::vector<std::string> CsvHeader(std::string_view text, const std::string& name,
                                   char delimiter = ',');

// skipped: rows of data at the start that are not looked at.
CsvTable ReadCsv(std::string_view text, const std::string& name,
                 const std::vector<std::string>& columns, char delimiter = ',',
                 Eigen::Index skipped = 0);

}  // namespace sinew::recording
