#include "components/record/recording/csv.h"

#include <gtest/gtest.h>

#include <random>

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"

namespace sinew::recording {
namespace {

using types::Signal;

constexpr char kMap[] = R"(schema: sinew-csv-map/1
kind: rotary
time: {column: t, unit: ms}
signals:
  position: {column: angle, unit: deg, sign: -1}
  motor_current: {column: current, unit: A, scale: 0.5, offset: 1}
)";

std::string CsvError(const std::string& text, const std::vector<std::string>& columns = {"a", "b"},
                     const CsvFormat& format = {}) {
  try {
    ReadCsv(text, "data.csv", columns, format);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string MapError(const std::string& text) {
  try {
    ParseCsvMap(text, "map.yaml");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

std::string RunError(const std::string& text) {
  try {
    ReadCsvRun(text, "data.csv", ParseCsvMap(kMap, "map.yaml"));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Csv, ReadsNumbersExactly) {
  const CsvTable table =
      ReadCsv("a,b,text\n1.5,-2e-3,x\n+0.1,7.45e-06,y\n", "data.csv", {"b", "a"});
  ASSERT_EQ(table.values.size(), 2u);
  EXPECT_EQ(table.values[0][0], -2e-3);
  EXPECT_EQ(table.values[0][1], 7.45e-06);
  EXPECT_EQ(table.values[1][1], 0.1);
  EXPECT_EQ(table.lines, (std::vector<int>{2, 3}));
}

TEST(Csv, UnderstandsQuotesCommentsBlanksAndLineEnds) {
  const CsvTable table = ReadCsv(
      "\xEF\xBB\xBF# made by a rig\r\n\"a\", b ,\"c, d\"\r\n\r\n 1 , \"2\",\"x \"\"y\"\"\"\r\n# "
      "end\r\n3,4,z",
      "data.csv", {"a", "b"});
  ASSERT_EQ(table.lines.size(), 2u);
  EXPECT_EQ(table.lines[0], 4);
  EXPECT_EQ(table.values[0][0], 1);
  EXPECT_EQ(table.values[1][0], 2);
  EXPECT_EQ(table.values[1][1], 4);
  EXPECT_EQ(ReadCsv("a;b\n1;2\n", "data.csv", {"b"}, {';'}).values[0][0], 2);
}

TEST(Csv, NamesFileLineColumnAndWhatWasExpected) {
  EXPECT_EQ(
      CsvError("a,b\n1,2\n3,nan\n"),
      "data.csv:3: column 'b': the value is nan, expected a finite number (leave lost rows out)");
  EXPECT_EQ(CsvError("a,b\n1,inf\n").substr(0, 11), "data.csv:2:");
  EXPECT_EQ(CsvError("a,b\n1,\n"), "data.csv:2: column 'b': the cell is empty, expected a number");
  EXPECT_EQ(CsvError("a,b\n1,2x\n"),
            "data.csv:2: column 'b': '2x' is no number, expected one such as -1.5e-3");
  EXPECT_EQ(CsvError("a,b\n1,2\n3\n"),
            "data.csv:3: the row has 1 cells, expected 2 as in the header");
  EXPECT_EQ(CsvError("a,c\n1,2\n"), "data.csv:1: no column 'b', the file has: a, c");
  EXPECT_EQ(CsvError("a,b,b\n1,2,3\n"), "data.csv:1: column 'b' is there 2 times, expected once");
  EXPECT_EQ(CsvError(""),
            "data.csv:1: the file is empty, expected a header line with column names");
  EXPECT_EQ(CsvError("a,b\n"), "data.csv:2: no row of data, expected at least one");
  EXPECT_EQ(CsvError("a,b\n1,1e999\n"), "data.csv:2: column 'b': '1e999' does not fit a double");
  EXPECT_EQ(CsvError("a,b\n\"1,2\n"), "data.csv:2: a quoted cell does not end");
}

// The same three rows as loggers, Excel, NumPy and people write them.
TEST(Csv, UnderstandsWhatAFileSaysOfItself) {
  const auto utf16 = [](const std::string& text, bool big_endian) {
    std::string out = big_endian ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : text) out += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    return out;
  };
  const std::string plain = "t,q\n0,0\n0.5,1.25\n1,-2\n";
  const struct {
    std::string name, text;
    CsvFormat format{};
  } kCases[] = {
      {"plain", plain},
      {"UTF-16, little endian", utf16(plain, false)},
      {"UTF-16, big endian", utf16(plain, true)},
      {"CR", "t,q\r0,0\r0.5,1.25\r1,-2\r"},
      {"sep", "sep=;\r\nt;q\r\n0;0\r\n0.5;1.25\r\n1;-2\r\n"},
      {"decimal comma", "t;q\n0;0\n0,5;1,25\n1;-2\n", {';'}},
      {"quoted decimal comma", "t,q\n0,0\n\"0,5\",\"1,25\"\n1,-2\n"},
      {"header behind #", "# t,q\n0,0\n0.5,1.25\n1,-2\n"},
      {"header behind # and blanks", "# made by hand\n# t q\n0 0\n0.5  1.25\n 1 -2\n", {' '}},
      {"lines before the header", "Logger 2.1, serial 7\nstarted\n\nt,q\n0,0\n0.5,1.25\n1,-2\n"},
      {"empty cells at the end", "t,q\n0,0,\n0.5,1.25,\n1,-2,\n"},
      {"empty names at the end", "t,q,\n0,0,\n0.5,1.25,\n1,-2,\n"},
      {"no header", "0,0\n0.5,1.25\n1,-2\n", {',', {"t", "q"}}},
      {"line break in a cell", "t,note,q\n0,,0\n0.5,\"a\r\nb\",1.25\n1,\"\"\"x\"\"\",-2\n"},
  };
  for (const auto& [name, text, format] : kCases) {
    const CsvTable table = ReadCsv(text, "data.csv", {"t", "q"}, format);
    ASSERT_EQ(table.lines.size(), 3u) << name;
    EXPECT_EQ(table.values[0], Eigen::Vector3d(0.0, 0.5, 1.0)) << name;
    EXPECT_EQ(table.values[1], Eigen::Vector3d(0.0, 1.25, -2.0)) << name;
  }
}

// Every combination of delimiter, decimal sign, line end, header and encoding.
TEST(Csv, CombinationsOfDialectsReadTheSame) {
  const auto encoded = [](const std::string& text, int encoding) {
    if (encoding == 0) return text;
    if (encoding == 1) return "\xEF\xBB\xBF" + text;
    std::string out = encoding == 2 ? "\xFF\xFE" : "\xFE\xFF";
    for (const char c : text) {
      out += encoding == 2 ? std::string{c, '\0'} : std::string{'\0', c};
    }
    return out;
  };
  int read = 0;
  for (const char delimiter : {',', ';', '\t', ' '}) {
    for (const char decimal : {'.', ','}) {
      for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const std::string before : {"", "# ", "Logger 7\n\n", "sep=", "\"made by\" a rig\n"}) {
          for (int encoding = 0; encoding < 4; ++encoding) {
            std::string text = before;
            if (before == "sep=") text += std::string(1, delimiter) + "\n";
            for (const std::vector<std::string>& row : {std::vector<std::string>{"t", "note", "q"},
                                                        {"0", "x", "-1.5"},
                                                        {"0.25", "y", "2.75e-1"},
                                                        {"1", "z", "3"}}) {
              for (std::size_t i = 0; i < row.size(); ++i) {
                std::string cell = row[i];
                std::replace(cell.begin(), cell.end(), '.', decimal);
                const bool quoted = cell.find(delimiter) != std::string::npos;
                if (i > 0) text += delimiter;
                text += quoted ? '"' + cell + '"' : cell;
              }
              text += '\n';
            }
            std::string with_ends;
            for (const char c : text) with_ends += c == '\n' ? end : std::string(1, c);
            const CsvFormat format{before == "sep=" ? ',' : delimiter};
            const CsvTable table =
                ReadCsv(encoded(with_ends, encoding), "data.csv", {"t", "q"}, format);
            ASSERT_EQ(table.lines.size(), 3u) << text;
            EXPECT_EQ(table.values[0], Eigen::Vector3d(0.0, 0.25, 1.0)) << text;
            EXPECT_EQ(table.values[1], Eigen::Vector3d(-1.5, 0.275, 3.0)) << text;
            ++read;
          }
        }
      }
    }
  }
  EXPECT_EQ(read, 4 * 2 * 3 * 5 * 4);
}

TEST(Csv, LinesAreCountedAsAnEditorDoes) {
  EXPECT_EQ(ReadCsv("a,b\n\n1,\"x\ny\"\n# c\n2,z\n", "data.csv", {"a"}).lines,
            (std::vector<int>{3, 6}));
}

TEST(Csv, SaysWhichDelimiterOrHeaderIsMissing) {
  EXPECT_EQ(CsvError("x\na;b\n1;2\n"),
            "data.csv:2: the columns stand apart by another delimiter, add 'delimiter: semicolon' "
            "to the mapping");
  CsvFormat named;
  named.header = {"a", "b"};
  EXPECT_EQ(CsvError("1\t2\n", {"a"}, named),
            "data.csv:1: the columns stand apart by another delimiter, add 'delimiter: tab' to the "
            "mapping");
  EXPECT_EQ(CsvError("1,2\n3,4\n"),
            "data.csv:1: numbers, expected a header line with column names; where a file has "
            "none, 'header: [NAME, ...]' in the mapping names its columns");
  EXPECT_EQ(CsvError("a,b\n0.5,1\n\"0,5\",1\n"),
            "data.csv:3: column 'a': ',' as decimal sign, and '.' before, expected one");
  EXPECT_EQ(CsvError("\xFF\xFE"
                     "a"),
            "data.csv: begins as UTF-16 and is none");
}

TEST(Csv, ColumnsOfTimeMayHoldDatesAndTimesOfDay) {
  const auto read = [](const std::string& first, const std::string& second) {
    return ReadCsv("t,q\n" + first + ",0\n" + second + ",1\n", "data.csv", {"t", "q"}, {}, 0, 1);
  };
  const CsvTable dates = read("2024-05-01T12:00:00.250Z", "2024-05-01 14:00:01+02:00");
  EXPECT_TRUE(dates.has_dates);
  EXPECT_EQ(dates.values[0], Eigen::Vector2d(1714564800.25, 1714564801.0));
  const CsvTable times = read("12:00:00", "\"12:00:00,010\"");
  EXPECT_TRUE(times.has_times_of_day);
  EXPECT_EQ(times.values[0], Eigen::Vector2d(43200.0, 43200.01));
  for (const char* text : {"2024-13-01T00:00:00", "2024-05-01T12:00", "12:61:00", "24:00:00",
                           "12:00:00.", "2024-05-01T12:00:00+1", "May 1st"}) {
    EXPECT_THROW(read("0", text), std::invalid_argument) << text;
  }
  EXPECT_THROW(ReadCsv("t,q\n0,12:00:00\n", "data.csv", {"t", "q"}, {}, 0, 1),
               std::invalid_argument);
}

TEST(Csv, NeverCrashesOnRandomText) {
  std::mt19937_64 random(3);
  const std::string alphabet = "ab,;\"\n\r#1.e- \\";
  for (int round = 0; round < 5000; ++round) {
    std::string text = round % 2 == 0 ? "a,b\n" : "";
    const auto size = random() % 60;
    for (std::uint64_t i = 0; i < size; ++i) text += alphabet[random() % alphabet.size()];
    (void)CsvError(text);
  }
}

TEST(CsvMap, AppliesUnitScaleOffsetAndSign) {
  const types::Run run =
      ReadCsvRun("t,angle,current\n0,90,2\n4,180,-2\n", "data.csv", ParseCsvMap(kMap, "map.yaml"));
  EXPECT_EQ(run.kind, types::JointKind::kRevolute);
  EXPECT_EQ(run.time_s[1], 0.004);
  EXPECT_DOUBLE_EQ(run.At(Signal::kPosition)[1], -3.14159265358979312);
  EXPECT_EQ(run.At(Signal::kMotorCurrent)[0], 2.0);  // 0.5 * 2 + 1
  EXPECT_EQ(run.At(Signal::kMotorCurrent)[1], 0.0);
  EXPECT_FALSE(run.Has(Signal::kVelocity));
  EXPECT_EQ(run.content_hash.size(), 16u);
}

TEST(CsvMap, ACellMayBeAProductOfColumns) {
  const CsvMap map = ParseCsvMap(R"(schema: sinew-csv-map/1
kind: rotary
time: {column: t, unit: s}
signals:
  drive_voltage: {column: duty, times: [bus, on], unit: V, scale: 0.5, offset: 1, sign: -1}
)",
                                 "map.yaml");
  const std::string text = "t,duty,bus,on\n0,0.5,8,1\n1,0.5,8,0\n";
  const types::Run run = ReadCsvRun(text, "data.csv", map);
  EXPECT_DOUBLE_EQ(run.At(Signal::kDriveVoltage)[0], -3.0);  // -(0.5 * (0.5 * 8 * 1) + 1)
  EXPECT_DOUBLE_EQ(run.At(Signal::kDriveVoltage)[1], -1.0);
  try {
    ReadCsvRun("t,duty,bus\n0,1,1\n", "data.csv", map);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "map.yaml:5: key 'signals.drive_voltage.column': no column 'on' in data.csv, "
                 "expected one of: t, duty, bus");
  }
}

std::string OneSignal(const std::string& signal) {
  return "schema: sinew-csv-map/1\nkind: rotary\njoints: 2\ntime: {column: t, unit: s}\nsignals:\n "
         " " +
         signal + "\n";
}

TEST(CsvMap, ACellMayBeASumOfColumnsAndAConstant) {
  const auto read = [](const std::string& signal, int joint = 0) {
    return ReadCsvRun("t,a1,b1,a2,b2,g\n0,10,4,1,7,2\n1,20,-4,2,8,3\n", "data.csv",
                      ParseCsvMap(OneSignal(signal), "map.yaml"), joint);
  };
  // The loss of a gear: what the motor gives less what arrives.
  const std::string loss = R"(torque: {columns: {"a{joint}": 1, "b{joint}": -1}, unit: Nm})";
  EXPECT_EQ(read(loss).At(Signal::kTorque), Eigen::Vector2d(6.0, 24.0));
  EXPECT_EQ(read(loss, 1).At(Signal::kTorque), Eigen::Vector2d(-6.0, -6.0));
  const types::Run all = read(
      "torque: {columns: {a1: 2, b1: -0.5}, constant: 3, times: [g], scale: 10, offset: 1, "
      "unit: mNm, sign: -1}");
  EXPECT_DOUBLE_EQ(all.At(Signal::kTorque)[0], -1e-3 * (10.0 * (2 * 10 - 0.5 * 4 + 3) * 2 + 1));
  EXPECT_EQ(read("payload: {constant: 500, unit: g}").At(Signal::kPayload),
            Eigen::Vector2d(0.5, 0.5));
  EXPECT_EQ(read("torque: {column: a1, constant: -1, unit: Nm}").At(Signal::kTorque)[0], 9.0);
}

TEST(CsvMap, ASumNamesTheLineOfItsMissingColumn) {
  const CsvMap map =
      ParseCsvMap(OneSignal("torque:\n    unit: Nm\n    columns: {a: 1, none: -1}"), "map.yaml");
  try {
    ReadCsvRun("t,a\n0,1\n", "data.csv", map);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "map.yaml:8: key 'signals.torque.columns': no column 'none' in data.csv, expected "
                 "one of: t, a");
  }
  EXPECT_EQ(MapError(OneSignal("torque: {columns: {a: 1}, column: a, unit: Nm}")),
            "map.yaml:6: key 'signals.torque.columns': beside 'column', expected one column or a "
            "sum, not both");
  EXPECT_EQ(MapError(OneSignal("torque: {columns: {a: 0}, unit: Nm}")),
            "map.yaml:6: key 'signals.torque.columns.a': is 0, expected another factor");
  EXPECT_EQ(MapError(OneSignal("torque: {columns: {}, unit: Nm}")),
            "map.yaml:6: key 'signals.torque.columns': is empty, expected {COLUMN: FACTOR, ...}, "
            "such as {a: 1, b: -1}");
  EXPECT_NE(MapError(OneSignal("torque: {columns: {a: x}, unit: Nm}")).find("columns.a"),
            std::string::npos);
  EXPECT_NE(MapError(OneSignal("torque: {unit: Nm}")).find("'signals.torque.column'"),
            std::string::npos);
}

TEST(CsvMap, AMappingOfConstantsAloneReadsNothing) {
  const CsvMap map = ParseCsvMap(
      "schema: sinew-csv-map/1\nkind: rotary\ntime: {row_period_s: 1}\n"
      "signals:\n  payload: {constant: 1, unit: kg}\n",
      "map.yaml");
  try {
    ReadCsvRun("t\n1\n", "data.csv", map);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "map.yaml: key 'signals': no column of data.csv is read, expected at least one");
  }
}

TEST(CsvMap, AnEncodersZeroMayDifferByRecording) {
  const std::string text = "t,a\n0,1\n1,2\n";
  const auto zero = [&](const std::string& signal) {
    return ReadCsvRun(text, "data.csv", ParseCsvMap(OneSignal(signal), "map.yaml")).zero_unknown;
  };
  EXPECT_EQ(zero("position: {column: a, unit: rad, zero_per_recording: true}"),
            std::set<Signal>{Signal::kPosition});
  EXPECT_TRUE(zero("position: {column: a, unit: rad, zero_per_recording: false}").empty());
  EXPECT_EQ(MapError(OneSignal("torque: {column: a, unit: Nm, zero_per_recording: true}")),
            "map.yaml:6: key 'signals.torque.zero_per_recording': beside a signal without an "
            "encoder, expected it at position or motor_position");
}

TEST(CsvMap, OneMappingReadsEveryJointOfAnArm) {
  const CsvMap map = ParseCsvMap(R"(schema: sinew-csv-map/1
kind: rotary
joints: 2
time: {column: t, unit: s}
signals:
  position: {column: "q{joint}_rad", unit: rad}
)",
                                 "map.yaml");
  const std::string text = "t,q1_rad,q2_rad\n0,1,2\n1,3,4\n";
  EXPECT_EQ(ReadCsvRun(text, "data.csv", map, 0).At(Signal::kPosition)[1], 3.0);
  EXPECT_EQ(ReadCsvRun(text, "data.csv", map, 1).At(Signal::kPosition)[1], 4.0);
  try {
    ReadCsvRun(text, "data.csv", map, 2);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "data.csv: joint 2 is asked for, the mapping map.yaml describes joints 0 to 1");
  }
}

// A row of units, an empty cell, a stamp of another clock: what is left out need be no numbers.
TEST(CsvMap, RowsThatAreLeftOutAreNotParsed) {
  const auto map = [](const std::string& rows) {
    return ParseCsvMap("schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n" +
                           rows + "signals:\n  position: {column: q, unit: rad}\n",
                       "map.yaml");
  };
  for (const std::string first : {"s,rad", "0,", "1716900000.0,1", "1,1"}) {
    const types::Run run =
        ReadCsvRun("t,q\n" + first + "\n1,5\n2,6\n", "data.csv", map("rows: {skip: 1}\n"));
    ASSERT_EQ(run.size(), 2) << first;
    EXPECT_EQ(run.time_s[0], 1.0) << first;
    EXPECT_EQ(run.At(Signal::kPosition)[1], 6.0) << first;
  }
  // Of the first seconds the stamps are read and nothing else.
  const types::Run later =
      ReadCsvRun("t,q\n0,\n1,none\n2,6\n3,7\n", "data.csv", map("rows: {skip_s: 2}\n"));
  ASSERT_EQ(later.size(), 2);
  EXPECT_EQ(later.time_s[0], 2.0);
  try {
    ReadCsvRun("t,q\n0,1\n1,2\n", "data.csv", map("rows: {skip: 2}\n"));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "data.csv: has 2 rows, of which the first 2 are left out, expected a longer recording");
  }
}

TEST(CsvMap, RowsWithoutStampsAreNumberedAndTheFirstOnesLeftOut) {
  const auto map = [](const std::string& rows) {
    return ParseCsvMap("schema: sinew-csv-map/1\nkind: rotary\ntime: {row_period_s: 3}\n" + rows +
                           "signals:\n  position: {column: q, unit: rad}\n",
                       "map.yaml");
  };
  const std::string text = "q\n5\n6\n7\n8\n";
  const types::Run all = ReadCsvRun(text, "data.csv", map(""));
  EXPECT_EQ(all.time_s[3], 9.0);
  const types::Run later = ReadCsvRun(text, "data.csv", map("rows: {skip: 2}\n"));
  ASSERT_EQ(later.size(), 2);
  EXPECT_EQ(later.time_s[0], 6.0);
  EXPECT_EQ(later.At(Signal::kPosition)[0], 7.0);
  EXPECT_EQ(ReadCsvRun(text, "data.csv", map("rows: {skip_s: 3}\n")).size(), 3);
  EXPECT_THROW(ReadCsvRun(text, "data.csv", map("rows: {skip: 9}\n")), std::invalid_argument);
  EXPECT_TRUE(ReadCsvRun(text, "data.csv", map("rows: {held: true}\n")).held);
  EXPECT_FALSE(all.held);
  EXPECT_EQ(
      MapError("schema: sinew-csv-map/1\nkind: rotary\n"
               "time: {row_period_s: 3, column: t, unit: s}\n"
               "signals:\n  position: {column: q, unit: rad}\n"),
      "map.yaml:3: key 'time.row_period_s': beside 'column', expected stamps or a period, not "
      "both");
}

TEST(CsvMap, NamesTheMappingLineOfAMissingColumn) {
  EXPECT_EQ(RunError("t,current\n0,1\n"),
            "map.yaml:5: key 'signals.position.column': no column 'angle' in data.csv, expected "
            "one of: t, current");
}

TEST(CsvMap, TimesOfDayGoOnPastMidnightAndAreSeconds) {
  const std::string map =
      "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n"
      "signals:\n  position: {column: q, unit: rad}\n";
  const std::string text = "t,q\n23:59:59.5,0\n00:00:00.5,1\n00:00:01.5,2\n";
  const types::Run run = ReadCsvRun(text, "data.csv", ParseCsvMap(map, "map.yaml"));
  EXPECT_EQ(run.time_s, Eigen::Vector3d(86399.5, 86400.5, 86401.5));
  EXPECT_EQ(RunError("t,angle,current\n12:00:00,1,1\n12:00:01,2,2\n"),
            "map.yaml:3: key 'time.column': data.csv has dates or times of day in it, expected "
            "unit s and no scale");
}

TEST(CsvMap, RefusesTimeThatDoesNotRise) {
  EXPECT_EQ(
      RunError("t,angle,current\n0,1,1\n2,1,1\n2,1,1\n"),
      "data.csv:4: column 't': time 0.002000 s follows 0.002000 s, expected strictly rising time");
}

TEST(CsvMap, RefusesWrongUnitsNamesAndKeys) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kMap;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::string unit = MapError(with("unit: deg", "unit: mm"));
  EXPECT_NE(unit.find("map.yaml:5: key 'signals.position.unit': unit 'mm'"), std::string::npos)
      << unit;
  EXPECT_NE(unit.find("rad, mrad, deg, rev, arcmin"), std::string::npos) << unit;
  const std::string name = MapError(with("motor_current", "current"));
  EXPECT_NE(name.find("map.yaml:6: key 'signals.current'"), std::string::npos) << name;
  EXPECT_NE(name.find("motor_current"), std::string::npos) << name;
  EXPECT_NE(MapError(with("sign: -1", "sign: 2")).find("sign"), std::string::npos);
  EXPECT_NE(MapError(with("scale: 0.5", "scale: 0")).find("scale"), std::string::npos);
  EXPECT_NE(MapError(with("scale: 0.5", "gain: 0.5")).find("gain"), std::string::npos);
  EXPECT_NE(MapError(with("kind: rotary", "kind: round")).find("kind"), std::string::npos);
  EXPECT_NE(MapError(with("csv-map/1", "csv-map/2")).find("schema"), std::string::npos);
}

TEST(ContentHash, ChangesWithEveryKindOfContent) {
  const CsvMap map = ParseCsvMap(kMap, "map.yaml");
  const auto hash = [&](const char* text) { return ReadCsvRun(text, "x", map).content_hash; };
  const std::string base = hash("t,angle,current\n0,1,1\n1,2,2\n");
  EXPECT_EQ(base, hash("t,angle,current\n0,1,1\n1,2,2.0\n"));
  EXPECT_NE(base, hash("t,angle,current\n0,1,1\n1,2,2.0000001\n"));
  EXPECT_NE(base, hash("t,angle,current\n0,1,1\n1.001,2,2\n"));
}

}  // namespace
}  // namespace sinew::recording
