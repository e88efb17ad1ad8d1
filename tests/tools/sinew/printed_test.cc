#include "tools/sinew/printed.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace sinew::tools {
namespace {

TEST(PrintableOnly, ShowsWhatWouldControlTheTerminal) {
  std::ostringstream out;
  {
    const PrintableOnly filter(out);
    out << "name \x1b[2J" << '\x07' << std::setw(4) << 7 << "\t|\n";
    Unfiltered(out) << "\x1b[K";
  }
  out << "\x1b[m";
  EXPECT_EQ(out.str(), "name \\u001b[2J\\u0007   7\t|\n\x1b[K\x1b[m");
  EXPECT_EQ(&Unfiltered(out), &out);
}

TEST(PrintableOnly, ReportsAStreamThatFails) {
  std::ofstream nowhere;  // not open
  const PrintableOnly filter(nowhere);
  nowhere << "a";
  EXPECT_FALSE(nowhere.good());
}

TEST(Print, PassesTheFilter) {
  std::ostringstream out;
  std::streambuf* before = std::cout.rdbuf(out.rdbuf());
  {
    const PrintableOnly filter(std::cout);
    Print("%-3s|%d %s", "a", 5, "\x1b");
  }
  std::cout.rdbuf(before);
  EXPECT_EQ(out.str(), "a  |5 \\u001b");
}

}  // namespace
}  // namespace sinew::tools
