#include "components/record/recording/file/csv_map_file.h"

#include "components/base/types/joined.h"

namespace sinew::recording {
// A sum in place of a column; its line, 0: there is none.
static int DescribeSum(config::Fields& f, std::vector<Summand>* sum) {
  config::Numbers factors;
  if (!f.reads()) f("columns", factors, "a sum in its place: {COLUMN: FACTOR, ...}");
  if (!f.reads() || !f.section().Has("columns")) return 0;
  if (f.section().Has("column")) {
    f.Fail("columns", "beside 'column', expected one column or a sum, not both");
  }
  const config::Section columns = f.section().Child("columns");
  for (const std::string& column : columns.Keys()) {
    sum->push_back({column, columns.Number(column)});
    if (sum->back().factor == 0.0) columns.Fail(column, "is 0, expected another factor");
  }
  if (sum->empty()) {
    f.Fail("columns", "is empty, expected {COLUMN: FACTOR, ...}, such as {a: 1, b: -1}");
  }
  return columns.line();
}

// Sets all but the sign. path: of the mapping, for messages about cells.
static void Describe(config::Fields& f, ColumnMap& c, const std::string& path, Quantity quantity,
                     bool may_be_constant) {
  std::optional<std::string> column;
  std::string unit;
  f("column", column, "of the header, {joint}: its number");
  const int sum_line = DescribeSum(f, &c.sum);
  if (may_be_constant) f("constant", c.constant, "added, or alone");
  f("times", c.times, "columns that the cell is multiplied by");
  f("unit", unit, "of the column (docs/formats.md); needed with one");
  f("scale", c.scale, "SI value = sign * (scale * cell in SI + offset)");
  f("offset", c.offset, "in SI");
  if (!f.reads()) return;
  if (unit.empty()) unit = f.section().Text("unit");
  const auto found = FindUnit(quantity, unit);
  if (!found) {
    f.Fail("unit", "unit '" + unit + "', expected one of: " + AcceptedUnits(quantity));
  }
  c.unit = *found;
  if (c.scale == 0.0) f.Fail("scale", "is 0, expected another number");
  if (sum_line == 0 && (column || !may_be_constant || !f.section().Has("constant"))) {
    c.sum.push_back({f.section().Text("column"), 1.0});
  }
  const int line = sum_line > 0 ? sum_line : f.section().line();
  c.where = f.section().file().string() + ":" + std::to_string(line) + ": key '" + path +
            (sum_line > 0 ? ".columns'" : ".column'");
}

static void DescribeSignal(config::Fields& f, const std::string& name, CsvMap* map) {
  SignalColumn c{.signal = *types::SignalFromName(name), .map = {}};
  Describe(f, c.map, "signals." + name, QuantityOf(c.signal, map->kind), true);
  f("sign", c.map.sign, "1 or -1");
  if (c.map.sign != 1.0 && c.map.sign != -1.0) {
    f.Fail("sign", "is neither 1 nor -1, expected 1 or -1");
  }
  // Only an encoder has a zero that a recording may begin with.
  const bool has_zero =
      c.signal == types::Signal::kPosition || c.signal == types::Signal::kMotorPosition;
  if (has_zero || f.reads()) {
    f("zero_per_recording", c.zero_per_recording, "its zero is another in each recording");
  }
  if (f.reads() && !has_zero && f.section().Has("zero_per_recording")) {
    f.Fail("zero_per_recording",
           "beside a signal without an encoder, expected it at position or motor_position");
  }
  map->signals.push_back(std::move(c));
}

void Describe(config::Fields& f, CsvMap& c) {
  f.NeedWord("kind", c.kind,
             {{"rotary", types::JointKind::kRevolute}, {"linear", types::JointKind::kPrismatic}},
             "of the joint");
  f.Word("delimiter", c.format.delimiter,
         {{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"space", ' '}}, "between columns");
  f("header", c.format.header, "names of the columns where the file has no header");
  f("joints", c.joints, {1.0, 64.0}, "that {joint} counts");
  f("joint_names", c.joint_names, "that {joint} stands for, in place of joints");
  f.Object("rows", "which count", [&](config::Fields& g) {
    g("skip", c.skipped_rows, config::kNotNegative, "rows at the start that are left out");
    g("held", c.held, "every row is a position held");
    g("skip_s", c.skipped_s, config::kNotNegative, "earlier ones, after the first, are left out");
  });
  f.NeedObject("time", "stamps, or the time between rows", [&](config::Fields& g) {
    std::optional<double> row_period_s;
    g("row_period_s", row_period_s, config::kPositive, "rows without stamps are this far apart");
    c.row_period_s = row_period_s.value_or(0.0);
    if (!row_period_s) return Describe(g, c.time, "time", Quantity::kTime, false);
    if (g.section().Has("column")) {
      g.Fail("row_period_s", "beside 'column', expected stamps or a period, not both");
    }
  });
  f.NeedObject("signals", "docs/formats.md", [&](config::Fields& g) {
    std::vector<std::string> known;
    for (const types::Signal one : types::AllSignals()) known.emplace_back(types::SignalName(one));
    for (const std::string& name : g.reads() ? g.section().Keys() : known) {
      if (!types::SignalFromName(name)) {
        g.Fail(name, "is no signal, expected one of: " + types::Joined(known));
      }
      g.Object(name, "where it is", [&](config::Fields& h) { DescribeSignal(h, name, &c); });
    }
  });
  f.Require(!c.signals.empty(), "signals", "is empty, expected at least one signal");
  f.Require(c.joint_names.empty() || c.joints == 1, "joints",
            "beside 'joint_names', expected one of them");
  if (!c.joint_names.empty()) c.joints = static_cast<int>(c.joint_names.size());
}

static CsvMap Named(CsvMap map, const std::string& name) {
  map.name = name;
  return map;
}

CsvMap LoadCsvMap(const std::filesystem::path& path) {
  return Named(config::Read<CsvMap>(config::Section::Load(path, kSchema)), path.string());
}

CsvMap ParseCsvMap(const std::string& text, const std::string& name) {
  return Named(config::Read<CsvMap>(config::Section::Parse(text, name, kSchema)), name);
}

}  // namespace sinew::recording
