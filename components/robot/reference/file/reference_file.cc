#include "components/robot/reference/file/reference_file.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "components/base/types/joints.h"
#include "components/robot/reference/file/squat_file.h"

namespace sinew::reference {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

// Keys carry the unit of the joint's kind: position_rad or position_m.
struct Units {
  std::string length;  // rad or m
  std::string Key(std::string_view stem, std::string_view per = "") const {
    return std::string(stem) + "_" + length + std::string(per);
  }
};

TrajectoryPtr ReadSine(const Section& s, const Units& units, double center, double duration_s) {
  SineConfig c;
  c.center_rad = center;
  c.amplitude_rad = s.Number(units.Key("amplitude"), kNotNegative);
  c.frequency_Hz = s.Number("frequency_Hz", kPositive);
  c.phase_rad = s.NumberOr("phase_rad", 0.0);
  c.duration_s = duration_s;
  return std::make_shared<Sine>(c);
}

TrajectoryPtr ReadChirp(const Section& s, const Units& units, double center, double duration_s) {
  ChirpConfig c;
  c.center_rad = center;
  c.amplitude_rad = s.Number(units.Key("amplitude"), kNotNegative);
  if (std::isfinite(duration_s)) c.duration_s = duration_s;
  c.start_frequency_Hz = s.NumberOr("start_frequency_Hz", c.start_frequency_Hz, kPositive);
  c.end_frequency_Hz = s.NumberOr("end_frequency_Hz", c.end_frequency_Hz, kPositive);
  c.upper_amplitude = s.NumberOr("upper_amplitude", c.upper_amplitude);
  c.lower_amplitude = s.NumberOr("lower_amplitude", c.lower_amplitude);
  c.upper_frequency_Hz = s.NumberOr("upper_frequency_Hz", c.upper_frequency_Hz, kNotNegative);
  c.lower_frequency_Hz = s.NumberOr("lower_frequency_Hz", c.lower_frequency_Hz, kNotNegative);
  c.upper_phase_rad = s.NumberOr("upper_phase_rad", c.upper_phase_rad);
  c.lower_phase_rad = s.NumberOr("lower_phase_rad", c.lower_phase_rad);
  if (c.upper_amplitude == 0.0 && c.lower_amplitude == 0.0) {
    s.Fail("upper_amplitude", "is 0 and so is lower_amplitude, expected one that is not");
  }
  return std::make_shared<Chirp>(c);
}

TrajectoryPtr ReadMultisine(const Section& s, const Units& units, double center,
                            double duration_s) {
  MultisineConfig c;
  c.center_rad = center;
  c.amplitude_rad = s.Number(units.Key("amplitude"), kNotNegative);
  c.lowest_frequency_Hz = s.Number("lowest_frequency_Hz", kPositive);
  c.highest_frequency_Hz = s.Number("highest_frequency_Hz", kPositive);
  c.period_s = s.Number("period_s", kPositive);
  c.tilt = s.NumberOr("tilt", c.tilt);
  c.seed = static_cast<std::uint64_t>(s.IntegerOr("seed", 1, kNotNegative));
  c.duration_s = duration_s;
  try {
    return std::make_shared<Multisine>(c);
  } catch (const std::invalid_argument& error) {
    s.Fail("highest_frequency_Hz", error.what());
  }
}

MoveConfig ReadMove(const Section& s, const Units& units) {
  MoveConfig c;
  c.speed_rad_s = s.Number(units.Key("speed", "_s"), kPositive);
  c.acceleration_rad_s2 = s.NumberOr(units.Key("acceleration", "_s2"), 2.0, kPositive);
  return c;
}

// Pieces of a sequence begin where the one before ended, at rest, and end at rest.
void AppendPiece(const Section& s, const Units& units, double* position,
                 std::vector<TrajectoryPtr>* pieces) {
  const std::string kind =
      s.Choice("kind", {"hold", "move", "ramps", "sine", "chirp", "multisine"});
  if (kind == "hold") {
    pieces->push_back(std::make_shared<Hold>(*position, s.Number("duration_s", kPositive)));
  } else if (kind == "move") {
    MoveConfig c = ReadMove(s, units);
    c.from_rad = *position;
    c.to_rad = s.Number(units.Key("to"));
    if (c.to_rad != c.from_rad) pieces->push_back(std::make_shared<Move>(c));
    *position = c.to_rad;
  } else if (kind == "ramps") {  // up, down, ... around the position, back to it at the end
    MoveConfig c = ReadMove(s, units);
    const double amplitude = s.Number(units.Key("amplitude"), kPositive);
    const std::int64_t cycles = s.IntegerOr("cycles", 1, {1, 10000});
    const double center = *position;
    const auto go = [&c, position, pieces](double to) {
      c.from_rad = *position;
      c.to_rad = to;
      pieces->push_back(std::make_shared<Move>(c));
      *position = to;
    };
    for (std::int64_t i = 0; i < cycles; ++i) {
      go(center + amplitude);
      go(center - amplitude);
    }
    go(center);
  } else {
    const double duration_s = s.Number("duration_s", kPositive);
    const double fade_s = s.NumberOr("fade_s", 1.0, kPositive);
    TrajectoryPtr inner;
    if (kind == "sine") inner = ReadSine(s, units, *position, kEndless);
    if (kind == "chirp") inner = ReadChirp(s, units, *position, duration_s);
    if (kind == "multisine") inner = ReadMultisine(s, units, *position, kEndless);
    if (2.0 * fade_s > duration_s) {
      s.Fail("fade_s", "two fades do not fit in duration_s, expected at most half of it");
    }
    pieces->push_back(std::make_shared<Windowed>(inner, *position, duration_s, fade_s));
  }
  s.RejectUnknownKeys();
}

GeneratorConfig ReadJoint(const Section& s, std::size_t index, LoadedReference* loaded) {
  const bool linear = s.ChoiceOr("joint", "rotary", {"rotary", "linear"}) == "linear";
  const Units units{linear ? "m" : "rad"};
  GeneratorConfig joint;
  joint.soft_start_s = s.NumberOr("soft_start_s", 2.0, kNotNegative);
  joint.soft_stop_s = s.NumberOr("soft_stop_s", 1.0, kNotNegative);

  const std::string kind =
      s.Choice("kind", {"hold", "sine", "chirp", "step", "multisine", "sequence", "file"});
  double center = 0.0;
  double horizon_s = 1.0;  // of an endless trajectory, for the limits
  if (kind == "sequence") {
    center = s.NumberOr(units.Key("start"), 0.0);
    double position = center;
    std::vector<TrajectoryPtr> pieces;
    for (const Section& piece : s.List("pieces")) AppendPiece(piece, units, &position, &pieces);
    if (pieces.empty()) s.Fail("pieces", "is empty, expected at least one piece");
    joint.trajectory = std::make_shared<Sequence>(std::move(pieces));
  } else if (kind == "file") {
    const std::filesystem::path path = s.ExistingPath("path");
    CsvTrajectory csv = ReadTrajectoryCsv(path, s.TextOr("time_column", "time_s"),
                                          s.TextOr("position_column", units.Key("position")));
    const double sign = s.NumberOr("sign", 1.0, {-1.0, 1.0});
    const double offset = s.NumberOr(units.Key("offset"), 0.0);
    for (double& q : csv.position_rad) q = sign * q + offset;
    try {
      joint.trajectory =
          std::make_shared<Samples>(std::move(csv.time_s), std::move(csv.position_rad));
    } catch (const std::invalid_argument& error) {
      throw UsageError(path.string() + ": " + error.what() +
                       ", expected two or more rows with rising time");
    }
    center = joint.trajectory->At(0.0).position_rad;
  } else if (kind == "step") {
    StepConfig c;
    c.from_rad = s.NumberOr(units.Key("from"), 0.0);
    c.to_rad = s.Number(units.Key("to"));
    c.step_at_s = s.NumberOr("step_at_s", 1.0, kNotNegative);
    c.rise_s = s.NumberOr("rise_s", 0.0, kNotNegative);
    if (s.Has("duration_s")) c.duration_s = s.Number("duration_s", kPositive);
    center = c.from_rad;
    horizon_s = c.step_at_s + c.rise_s + 1.0;
    joint.trajectory = std::make_shared<Step>(c);
  } else {
    center = s.NumberOr(units.Key("center"), 0.0);
    const double duration_s = s.Has("duration_s") ? s.Number("duration_s", kPositive) : kEndless;
    if (kind == "hold") joint.trajectory = std::make_shared<Hold>(center, duration_s);
    if (kind == "sine") {
      joint.trajectory = ReadSine(s, units, center, duration_s);
      horizon_s = 1.0 / s.Number("frequency_Hz");
    }
    if (kind == "chirp") joint.trajectory = ReadChirp(s, units, center, duration_s);
    if (kind == "multisine") {
      joint.trajectory = ReadMultisine(s, units, center, duration_s);
      horizon_s = s.Number("period_s");
    }
  }

  const Section limits = s.ChildOrEmpty("limits");
  Limits& l = joint.limits;
  const std::string lower_key = units.Key("position_lower");
  l.position_lower_rad = limits.NumberOr(lower_key, l.position_lower_rad);
  l.position_upper_rad = limits.NumberOr(units.Key("position_upper"), l.position_upper_rad);
  l.velocity_rad_s = limits.NumberOr(units.Key("velocity", "_s"), l.velocity_rad_s, kPositive);
  l.acceleration_rad_s2 =
      limits.NumberOr(units.Key("acceleration", "_s2"), l.acceleration_rad_s2, kPositive);
  const std::string exceeded = limits.ChoiceOr("when_exceeded", "refuse", {"refuse", "scale"});
  if (!(l.position_lower_rad < l.position_upper_rad)) {
    limits.Fail(lower_key, "is not below position_upper, expected lower < upper");
  }
  const Extremes extremes = Measure(*joint.trajectory, horizon_s);
  double factor = 1.0;
  try {
    factor = FittingFactor(extremes, center, l);
  } catch (const std::invalid_argument& error) {
    s.Fail("limits", error.what());
  }
  if (factor < 1.0) {
    char demand[256];
    const char* unit = units.length.c_str();
    std::snprintf(demand, sizeof(demand),
                  "position %.4g to %.4g %s, velocity %.4g %s/s, acceleration %.4g %s/s2",
                  extremes.position_lower_rad, extremes.position_upper_rad, unit,
                  extremes.velocity_rad_s, unit, extremes.acceleration_rad_s2, unit);
    if (exceeded == "refuse") {
      s.Fail("limits", std::string("the trajectory asks for ") + demand +
                           ", expected one inside the limits (or when_exceeded: scale)");
    }
    char note[384];
    std::snprintf(note, sizeof(note),
                  "joint %zu: drawn in to %.4g of its size to keep the limits (asked for %s)",
                  index, factor, demand);
    loaded->notes.emplace_back(note);
    joint.trajectory = std::make_shared<Scaled>(joint.trajectory, center, factor);
  }
  limits.RejectUnknownKeys();
  s.RejectUnknownKeys();
  return joint;
}

}  // namespace

LoadedReference ReadReference(const config::Section& section) {
  LoadedReference loaded;
  loaded.config.start = section.ChoiceOr("start", "armed", {"armed", "operator"}) == "operator"
                            ? StartRule::kOperator
                            : StartRule::kArmed;
  loaded.config.start_delay_s = section.NumberOr("start_delay_s", 0.0, kNotNegative);
  loaded.config.hold_s = section.NumberOr("hold_s", 0.0, kNotNegative);
  if (section.Has("squat")) {
    if (section.Has("joints"))
      section.Fail("joints", "and 'squat' are there, expected one of them");
    ReadSquat(section.Child("squat"), &loaded);
    section.RejectUnknownKeys();
    return loaded;
  }
  const std::vector<Section> joints = section.List("joints");
  if (joints.empty() || joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    section.Fail("joints", "has " + std::to_string(joints.size()) + " entries, expected 1 to " +
                               std::to_string(types::kMaxJoints));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    loaded.config.joints.push_back(ReadJoint(joints[j], j, &loaded));
  }
  section.RejectUnknownKeys();
  return loaded;
}

LoadedReference LoadReference(const std::filesystem::path& path) {
  return ReadReference(Section::Load(path, "sinew-reference/1"));
}

CsvTrajectory ReadTrajectoryCsv(const std::filesystem::path& path, const std::string& time_column,
                                const std::string& position_column) {
  const std::string content = config::ReadFile(path, config::kLargestData);
  CsvTrajectory csv;
  int line_number = 0;
  int time_index = -1;
  int position_index = -1;
  std::size_t begin = 0;
  while (begin < content.size()) {
    std::size_t end = content.find('\n', begin);
    if (end == std::string::npos) end = content.size();
    std::string_view line(content.data() + begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    const bool header = time_index < 0;
    const std::string where = path.string() + ":" + std::to_string(line_number) + ": ";
    double time_s = std::nan("");
    double position_rad = std::nan("");
    int column = 0;
    for (std::size_t at = 0; at <= line.size(); ++column) {
      std::size_t stop = line.find(',', at);
      if (stop == std::string_view::npos) stop = line.size();
      std::string_view cell = line.substr(at, stop - at);
      at = stop + 1;
      while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
      while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
      if (header) {
        if (cell == time_column) time_index = column;
        if (cell == position_column) position_index = column;
      } else if (column == time_index || column == position_index) {
        double value = 0.0;
        const auto [rest, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error != std::errc() || rest != cell.data() + cell.size() || !std::isfinite(value)) {
          throw UsageError(where + "column '" +
                           (column == time_index ? time_column : position_column) + "': '" +
                           std::string(cell) + "', expected a finite number");
        }
        (column == time_index ? time_s : position_rad) = value;
      }
    }
    if (header) {
      for (const auto& [index, name] :
           {std::pair{time_index, &time_column}, {position_index, &position_column}}) {
        if (index < 0)
          throw UsageError(where + "no column '" + *name + "', expected it in the header line");
      }
      continue;
    }
    if (std::isnan(time_s) || std::isnan(position_rad)) {
      throw UsageError(where + "the row has " + std::to_string(column) + " columns, expected " +
                       std::to_string(std::max(time_index, position_index) + 1) + " or more");
    }
    if (!csv.time_s.empty() && !(time_s > csv.time_s.back())) {
      throw UsageError(where + "column '" + time_column +
                       "': time does not rise, expected more than " +
                       std::to_string(csv.time_s.back()));
    }
    csv.time_s.push_back(time_s);
    csv.position_rad.push_back(position_rad);
  }
  if (csv.time_s.size() < 2) {
    throw UsageError(path.string() + ": " + std::to_string(csv.time_s.size()) +
                     " rows, expected two or more");
  }
  return csv;
}

}  // namespace sinew::reference
