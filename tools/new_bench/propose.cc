#include "tools/new_bench/propose.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/joined.h"
#include "components/base/types/seconds.h"
#include "components/base/types/text.h"
#include "components/record/recording/units.h"

namespace sinew::new_bench {
namespace {

using recording::Quantity;
using types::Signal;

// Words of a column's name, lower case: "q_meas_rad" and "MotorCurrent [A]" have three.
std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words(1);
  bool was_lower = false;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = std::isalnum(byte) != 0;
    if ((!letter || (std::isupper(byte) != 0 && was_lower)) && !words.back().empty()) {
      words.emplace_back();
    }
    if (letter) words.back() += static_cast<char>(std::tolower(byte));
    was_lower = std::islower(byte) != 0;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

struct Kind {
  std::optional<Signal> signal;  // nothing: time
  std::vector<std::string> words;
};

// The first kind with a word of the name is the column's; the first column of a kind is taken.
const std::vector<Kind>& Kinds() {
  static const std::vector<Kind> kKinds = {
      {std::nullopt, {"t", "time", "timestamp", "stamp", "ts", "zeit"}},
      {Signal::kTemperature, {"temp", "temperature"}},
      {Signal::kChamberPressure, {"p", "pressure", "chamber"}},
      {Signal::kVelocity, {"dq", "qd", "vel", "velocity", "speed", "omega"}},
      {Signal::kMotorCurrent, {"i", "iq", "current", "cur", "amps"}},
      {Signal::kTorque, {"tau", "torque", "effort", "trq"}},
      {Signal::kDriveVoltage, {"u", "voltage", "volt", "volts"}},
      {Signal::kPosition, {"q", "pos", "position", "angle", "theta", "phi", "joint"}},
  };
  return kKinds;
}

bool HasAny(const std::vector<std::string>& words, const std::vector<std::string>& wanted) {
  return std::find_first_of(words.begin(), words.end(), wanted.begin(), wanted.end()) !=
         words.end();
}

// A column of what is asked for, not of what is measured.
bool IsWanted(const std::vector<std::string>& words) {
  return HasAny(words, {"ref", "reference", "des", "desired", "goal", "target", "cmd", "command",
                        "setpoint", "set"});
}

// The signal, where a column may be of the motor or of the output.
std::optional<Signal> Refined(std::optional<Signal> signal, const std::vector<std::string>& words) {
  const bool motor = HasAny(words, {"motor", "rotor"});
  if (signal == Signal::kPosition && IsWanted(words)) return Signal::kReferencePosition;
  if (signal == Signal::kPosition && motor) return Signal::kMotorPosition;
  if (signal == Signal::kVelocity && motor) return Signal::kMotorVelocity;
  return signal;
}

Quantity QuantityOf(std::optional<Signal> signal) {
  return signal ? recording::QuantityOf(*signal, types::JointKind::kRevolute) : Quantity::kTime;
}

// A unit at the end of a name: "rad_s", "A", "[deg]". The longest counts.
std::string UnitIn(std::string_view name, Quantity quantity) {
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '_';
  };
  while (!name.empty() && !is_part(name.back())) name.remove_suffix(1);
  for (std::size_t at = 1; at < name.size(); ++at) {
    if (is_part(name[at - 1]) && name[at - 1] != '_') continue;
    const std::string_view end = name.substr(at);
    if (const auto unit = recording::FindUnit(quantity, end)) return std::string(unit->name);
  }
  return "";
}

// Assumes a unit by the values where the name has none.
void Assume(const Eigen::VectorXd& values, Column* column) {
  const Quantity quantity = QuantityOf(column->signal);
  const double span = values.size() > 0 ? values.maxCoeff() - values.minCoeff() : 0.0;
  if (quantity == Quantity::kTime) {
    const double step = values.size() > 1 ? span / static_cast<double>(values.size() - 1) : 0.0;
    column->unit = step >= 1e5 ? "ns" : step >= 100.0 ? "us" : step >= 0.5 ? "ms" : "s";
    column->why = column->unit + " assumed: by the distance of two rows";
  } else if (quantity == Quantity::kAngle && span > 4.0 * types::kPi) {
    column->unit = "deg";
    column->why = "deg assumed: its values span more than two turns of radians";
  } else {
    column->unit = types::SignalUnit(*column->signal, types::JointKind::kRevolute);
    column->why = column->unit + " assumed: its name has no unit";
  }
}

char DelimiterOf(std::string_view text) {
  constexpr std::array kDelimiters = {',', ';', '\t'};
  if (text.starts_with("sep=")) text.remove_prefix(text.find_first_of("\r\n"));
  text.remove_prefix(std::min(text.find_first_not_of("\r\n"), text.size()));
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  const char most = *std::max_element(kDelimiters.begin(), kDelimiters.end(), [&](char a, char b) {
    return std::count(line.begin(), line.end(), a) < std::count(line.begin(), line.end(), b);
  });
  return line.find(most) == std::string_view::npos ? ' ' : most;  // names may have blanks
}

const Column* Find(const Guess& guess, Signal signal) {
  const auto at = std::find_if(guess.columns.begin(), guess.columns.end(),
                               [signal](const Column& c) { return c.signal == signal; });
  return at == guess.columns.end() ? nullptr : &*at;
}

// The column of the drive, by how directly it is a torque.
const Column* DriveOf(const Guess& guess) {
  for (const Signal signal : {Signal::kTorque, Signal::kMotorCurrent, Signal::kDriveVoltage}) {
    if (const Column* column = Find(guess, signal)) return column;
  }
  return nullptr;
}

const Column* AngleOf(const Guess& guess) {
  const Column* output = Find(guess, Signal::kPosition);
  return output != nullptr ? output : Find(guess, Signal::kMotorPosition);
}

std::string Number(double value) { return types::Text("%.10g", value); }

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + '"';
}

// To the position's reading: there a hanging link is at -90 degrees, where gravity turns it least.
double OffsetOf(const Column& angle, const Answers& answers) {
  const auto unit = recording::FindUnit(Quantity::kAngle, angle.unit);
  const double gear = angle.signal == Signal::kMotorPosition ? answers.gear_ratio : 1.0;
  return -*answers.hanging - 0.5 * types::kPi * gear / unit->ToSi(1.0);
}

std::string MapText(const Guess& guess, const Answers& answers) {
  std::string text =
      "# Which column is which signal, in which unit: docs/formats.md. Check every line.\n"
      "schema: sinew-csv-map/1\nkind: rotary\n";
  if (guess.format.delimiter == ';') text += "delimiter: semicolon\n";
  if (guess.format.delimiter == '\t') text += "delimiter: tab\n";
  if (guess.format.delimiter == ' ') text += "delimiter: space\n";
  if (!guess.format.header.empty()) {
    text += "header: [" + types::Joined(guess.format.header) + "]\n";
  }
  bool in_signals = false;
  for (const Column& column : guess.columns) {
    std::string line = "{column: " + Quoted(column.name) + ", unit: " + column.unit;
    if (!column.signal) {
      text += "time: " + line + "}   # " + column.why + "\n";
      continue;
    }
    if (!in_signals) text += "signals:\n";
    in_signals = true;
    if (&column == AngleOf(guess) && answers.hanging) {
      line += ", offset: " + Number(OffsetOf(column, answers));
    }
    if (&column == DriveOf(guess) && answers.drive_sign < 0) line += ", sign: -1";
    text += "  " + std::string(types::SignalName(*column.signal)) + ": " + line + "}   # " +
            column.why + "\n";
  }
  if (!guess.unused.empty()) text += "# not used: " + types::Joined(guess.unused) + "\n";
  return text;
}

std::string ModelText(const Guess& guess, const Answers& answers) {
  const Signal drive = *DriveOf(guess)->signal;
  std::string constants = "gear_ratio: " + Number(answers.gear_ratio);
  std::string drive_term = "drive_torque\n        gain: {value: 1, tolerance: 0.1}";
  if (drive == Signal::kMotorCurrent) {
    constants += ", torque_constant_Nm_A: " + Number(answers.torque_constant_Nm_A);
    drive_term = "drive_current\n        efficiency: {value: 0.9, tolerance: 0.2}";
  } else if (drive == Signal::kDriveVoltage) {
    drive_term =
        "drive_voltage\n        gain_Nm_V: 0.1   # nothing is known: only ratios are found";
  }
  if (answers.hanging) constants += ", gravity_m_s2: 9.81";
  std::string text =
      "# What is known of the joint before a recording: docs/formats.md. A value without a "
      "tolerance is a\n"
      "# start, of which nothing is known; {value: 0.02, tolerance: 0.1} is known to 10 %.\n"
      "schema: sinew-model/1\nname: " +
      Quoted(answers.joint) + "\njoints:\n  - name: " + Quoted(answers.joint) +
      "\n    kind: rotary\n    constants: {" + constants +
      "}\n    terms:\n      - effect: " + drive_term +
      "\n      - effect: inertia\n        inertia_kg_m2: 0.01\n      - effect: viscous\n"
      "        viscous_Nm_s_rad: 0.01\n      - effect: coulomb\n        coulomb_Nm: 0.01\n";
  if (answers.hanging)
    text += "      - effect: gravity\n        gravity_torque_Nm: 0.1   # m g l\n";
  return text + "    history: []\n";
}

std::string ReadmeText(const Guess& guess, const Answers& answers, const std::string& recording) {
  std::string text = "# " + answers.joint + "\n\nMade by `sinew new bench` from `" + recording +
                     "`. Check `csv_map.yaml` line by line: a wrong sign or unit is no effect that "
                     "a fit can find.\n\n"
                     "| column | signal | why |\n| --- | --- | --- |\n";
  for (const Column& column : guess.columns) {
    const std::string signal =
        column.signal ? std::string(types::SignalName(*column.signal)) : "time";
    text +=
        "| `" + column.name + "` | " + signal + ", " + column.unit + " | " + column.why + " |\n";
  }
  const std::string split = types::SecondsText(guess.split_s);
  text += "\n```sh\nsinew check-data --model model.yaml --map csv_map.yaml " + recording +
          "                 # faults of the data first\n"
          "sinew close-loop --model model.yaml --map csv_map.yaml " +
          recording + "@:" + split + " --held-out " + recording + "@" + split +
          ": --out result   # what comes later checks; better another recording\n```\n\n";
  text += answers.hanging ? "A hanging link is at -90 degrees in the model: gravity is `-m g l cos "
                            "q`. The offset of the angle in\n"
                            "`csv_map.yaml` comes from the reading at which it hangs.\n"
                          : "Gravity is not in the model. If it loads the joint, make the files "
                            "again with `--hanging READING`.\n";
  return text;
}

}  // namespace

Guess GuessColumns(std::string_view text, const std::string& name, std::vector<std::string> given) {
  Guess guess;
  guess.format.header = std::move(given);
  guess.format.delimiter = DelimiterOf(text);
  const std::vector<std::string> header = recording::CsvHeader(text, name, {}, guess.format);
  // Measured columns come before those of what was asked for.
  std::vector<std::string> in_turn = header;
  std::stable_partition(in_turn.begin(), in_turn.end(),
                        [](const std::string& column) { return !IsWanted(WordsOf(column)); });
  for (const std::string& column : in_turn) {
    const std::vector<std::string> words = WordsOf(column);
    const auto kind = std::find_if(Kinds().begin(), Kinds().end(),
                                   [&](const Kind& each) { return HasAny(words, each.words); });
    if (kind == Kinds().end()) {
      guess.unused.push_back(column);
      continue;
    }
    const std::optional<Signal> signal = Refined(kind->signal, words);
    const bool taken = std::any_of(guess.columns.begin(), guess.columns.end(),
                                   [&](const Column& c) { return c.signal == signal; });
    if (taken) {
      guess.unused.push_back(column);
    } else {
      guess.columns.push_back({column, signal});
    }
  }
  std::stable_partition(guess.columns.begin(), guess.columns.end(),
                        [](const Column& column) { return !column.signal; });
  const std::string all = types::Joined(header);
  if (guess.columns.empty() || guess.columns.front().signal) {
    throw std::invalid_argument(name + ": no column is a time by its name (" + all +
                                "), expected one such as 'time_s'");
  }
  if (AngleOf(guess) == nullptr) {
    throw std::invalid_argument(name + ": no column is an angle by its name (" + all +
                                "), expected one such as 'position_rad' or 'q'");
  }
  if (DriveOf(guess) == nullptr) {
    throw std::invalid_argument(name + ": no column drives by its name (" + all +
                                "), expected one such as 'torque_Nm', 'current_A' or 'voltage_V'");
  }
  std::vector<std::string> names;
  names.reserve(guess.columns.size());
  for (const Column& column : guess.columns) names.push_back(column.name);
  const recording::CsvTable table = recording::ReadCsv(text, name, names, guess.format, 0, 1);
  for (std::size_t k = 0; k < guess.columns.size(); ++k) {
    Column& column = guess.columns[k];
    column.unit = UnitIn(column.name, QuantityOf(column.signal));
    if (k == 0 && (table.has_dates || table.has_times_of_day)) {
      column.unit = "s";
      column.why = "dates or times of day";
    } else if (!column.unit.empty()) {
      column.why = "unit by its name";
    } else {
      Assume(table.values[k], &column);
    }
  }
  const Eigen::VectorXd& time = table.values.front();
  const auto unit = recording::FindUnit(Quantity::kTime, guess.columns.front().unit);
  if (time.size() > 0)
    guess.split_s = unit->ToSi(time[0] + 0.6 * (time[time.size() - 1] - time[0]));
  return guess;
}

bool NeedsTorqueConstant(const Guess& guess) {
  return DriveOf(guess)->signal == Signal::kMotorCurrent;
}

Files Propose(const Guess& guess, const Answers& answers, const std::string& recording) {
  if (!(answers.gear_ratio > 0.0)) {
    throw std::invalid_argument("gear ratio " + Number(answers.gear_ratio) + ", expected above 0");
  }
  if (NeedsTorqueConstant(guess) && !(answers.torque_constant_Nm_A > 0.0)) {
    throw std::invalid_argument("torque constant " + Number(answers.torque_constant_Nm_A) +
                                " Nm/A, expected above 0: the drive is a current");
  }
  return {MapText(guess, answers), ModelText(guess, answers),
          ReadmeText(guess, answers, recording)};
}

}  // namespace sinew::new_bench
