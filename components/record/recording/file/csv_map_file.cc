#include "components/record/recording/file/csv_map_file.h"

#include "components/base/config/config.h"

namespace sinew::recording {
namespace {

constexpr std::string_view kSchema = "sinew-csv-map/1";

ColumnMap ReadColumn(const config::Section& section, const std::string& path, Quantity quantity,
                     bool may_be_constant) {
  ColumnMap map;
  const auto where = [&](const config::Section& at, const char* key) {
    return section.file().string() + ":" + std::to_string(at.line()) + ": key '" + path + "." +
           key + "'";
  };
  map.where = where(section, "column");
  if (section.Has("columns")) {
    if (section.Has("column")) {
      section.Fail("columns", "beside 'column', expected one column or a sum, not both");
    }
    const config::Section columns = section.Child("columns");
    map.where = where(columns, "columns");
    for (const std::string& column : columns.Keys()) {
      map.sum.push_back({column, columns.Number(column)});
      if (map.sum.back().factor == 0.0) columns.Fail(column, "is 0, expected another factor");
    }
    if (map.sum.empty()) {
      section.Fail("columns", "is empty, expected {COLUMN: FACTOR, ...}, such as {a: 1, b: -1}");
    }
  } else if (section.Has("column") || !may_be_constant || !section.Has("constant")) {
    map.sum.push_back({section.Text("column"), 1.0});
  }
  if (may_be_constant) map.constant = section.NumberOr("constant", 0.0);
  map.times = section.TextsOr("times", {});
  const std::string unit = section.Text("unit");
  const auto found = FindUnit(quantity, unit);
  if (!found)
    section.Fail("unit", "unit '" + unit + "', expected one of: " + AcceptedUnits(quantity));
  map.unit = *found;
  map.scale = section.NumberOr("scale", 1.0);
  if (map.scale == 0.0) section.Fail("scale", "is 0, expected another number");
  map.offset = section.NumberOr("offset", 0.0);
  return map;
}

double ReadSign(const config::Section& section) {
  const double sign = section.NumberOr("sign", 1.0);
  if (sign != 1.0 && sign != -1.0) section.Fail("sign", "is neither 1 nor -1, expected 1 or -1");
  return sign;
}

// Only an encoder has a zero that a recording may begin with.
bool ReadZero(const config::Section& section, types::Signal signal) {
  if (!section.Has("zero_per_recording")) return false;
  if (signal != types::Signal::kPosition && signal != types::Signal::kMotorPosition) {
    section.Fail("zero_per_recording",
                 "beside a signal without an encoder, expected it at position or motor_position");
  }
  return section.BoolOr("zero_per_recording", false);
}

CsvMap Read(const config::Section& section) {
  CsvMap map;
  map.name = section.file().string();
  map.kind = section.Choice("kind", {"rotary", "linear"}) == "linear" ? types::JointKind::kLinear
                                                                      : types::JointKind::kRotary;
  const std::string delimiter =
      section.ChoiceOr("delimiter", "comma", {"comma", "semicolon", "tab", "space"});
  map.format.delimiter = delimiter == "semicolon" ? ';'
                         : delimiter == "tab"     ? '\t'
                         : delimiter == "space"   ? ' '
                                                  : ',';
  map.format.header = section.TextsOr("header", {});
  map.joints = static_cast<int>(section.IntegerOr("joints", 1, {1.0, 64.0}));
  const config::Section rows = section.ChildOrEmpty("rows");
  map.skipped_rows = rows.IntegerOr("skip", 0, config::kNotNegative);
  map.held = rows.BoolOr("held", false);
  map.skipped_s = rows.NumberOr("skip_s", 0.0, config::kNotNegative);
  const config::Section time = section.Child("time");
  if (time.Has("row_period_s")) {
    if (time.Has("column")) {
      time.Fail("row_period_s", "beside 'column', expected stamps or a period, not both");
    }
    map.row_period_s = time.Number("row_period_s", config::kPositive);
  } else {
    map.time = ReadColumn(time, "time", Quantity::kTime, false);
  }
  const config::Section signals = section.Child("signals");
  for (const std::string& name : signals.Keys()) {
    const auto signal = types::SignalFromName(name);
    if (!signal) {
      std::string list;
      for (const types::Signal known : types::AllSignals()) {
        list += (list.empty() ? "" : ", ") + std::string(types::SignalName(known));
      }
      signals.Fail(name, "is no signal, expected one of: " + list);
    }
    const config::Section entry = signals.Child(name);
    SignalColumn column{*signal,
                        ReadColumn(entry, "signals." + name, QuantityOf(*signal, map.kind), true)};
    column.map.sign = ReadSign(entry);
    column.zero_per_recording = ReadZero(entry, *signal);
    map.signals.push_back(std::move(column));
  }
  if (map.signals.empty()) section.Fail("signals", "is empty, expected at least one signal");
  section.RejectUnknownKeys();
  return map;
}

}  // namespace

CsvMap LoadCsvMap(const std::filesystem::path& path) {
  return Read(config::Section::Load(path, kSchema));
}

CsvMap ParseCsvMap(const std::string& text, const std::string& name) {
  return Read(config::Section::Parse(text, name, kSchema));
}

}  // namespace sinew::recording
