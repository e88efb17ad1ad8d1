#include "components/robot/reference/file/reference_file.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "components/base/types/joints.h"
#include "components/base/types/text.h"
#include "components/robot/reference/file/squat_file.h"

namespace sinew::reference {
using config::kNotNegative;
using config::kPositive;
using Choice = config::Fields::Choice;

// A trajectory as described; it is made when all keys were read.
struct Described {
  std::function<TrajectoryPtr()> make;  // throws std::invalid_argument
  double center_rad = 0.0;
  double horizon_s = 1.0;  // of an endless trajectory, for the limits
};

static void Describe(config::Fields& f, ChirpConfig& c) {
  f("start_frequency_Hz", c.start_frequency_Hz, kPositive, "f0");
  f("end_frequency_Hz", c.end_frequency_Hz, kPositive, "f1");
  f("upper_amplitude", c.upper_amplitude, "of the breathing, A_amp,max");
  f("lower_amplitude", c.lower_amplitude, "A_amp,min");
  f("upper_frequency_Hz", c.upper_frequency_Hz, kNotNegative, "of the breathing, f_amp,max");
  f("lower_frequency_Hz", c.lower_frequency_Hz, kNotNegative, "f_amp,min");
  f("upper_phase_rad", c.upper_phase_rad, "phi_max");
  f("lower_phase_rad", c.lower_phase_rad, "phi_min");
}

static void Describe(config::Fields& f, MultisineConfig& c) {
  f.Need("lowest_frequency_Hz", c.lowest_frequency_Hz, kPositive, "of the lines");
  f.Need("highest_frequency_Hz", c.highest_frequency_Hz, kPositive, "of the lines");
  f.Need("period_s", c.period_s, kPositive, "lines at multiples of 1 / period");
  f("tilt", c.tilt, "amplitude falls with this power of the frequency");
  f("seed", c.seed, kNotNegative, "of the phases");
}

static void Describe(config::Fields& f, MoveConfig& c) {
  f.Need("~speed_rad_s", c.speed_rad_s, kPositive, "of the way");
  c.acceleration_rad_s2 = 2.0;
  f("~acceleration_rad_s2", c.acceleration_rad_s2, kPositive, "at both ends");
}

// A sine, chirp or multisine around a centre.
static void DescribeWave(config::Fields& f, const Choice& kind, double duration_s, Described* out) {
  double amplitude_rad = 0.0;
  if (const auto wave = kind.Is({"sine", "chirp", "multisine"})) {
    f.Need("~amplitude_rad", amplitude_rad, kNotNegative, "around the centre");
  }
  if (const auto sine = kind.Is({"sine"})) {
    SineConfig c{.center_rad = out->center_rad, .amplitude_rad = amplitude_rad};
    f.Need("frequency_Hz", c.frequency_Hz, kPositive, "of the sine");
    f("phase_rad", c.phase_rad, "at time 0");
    c.duration_s = duration_s;
    out->horizon_s = 1.0 / c.frequency_Hz;
    out->make = [c] { return std::make_shared<Sine>(c); };
  }
  if (const auto chirp = kind.Is({"chirp"})) {
    ChirpConfig c{.center_rad = out->center_rad, .amplitude_rad = amplitude_rad};
    if (std::isfinite(duration_s)) c.duration_s = duration_s;
    Describe(f, c);
    out->make = [c] {
      if (c.upper_amplitude != 0.0 || c.lower_amplitude != 0.0) return std::make_shared<Chirp>(c);
      throw std::invalid_argument("upper_amplitude is 0 and so is lower_amplitude");
    };
  }
  if (const auto multisine = kind.Is({"multisine"})) {
    MultisineConfig c{.center_rad = out->center_rad, .amplitude_rad = amplitude_rad};
    Describe(f, c);
    c.duration_s = duration_s;
    out->horizon_s = c.period_s;
    out->make = [c] { return std::make_shared<Multisine>(c); };
  }
}

// Pieces of a sequence begin where the one before ended, at rest, and end at rest.
static void DescribePiece(config::Fields& f, double* position, std::vector<TrajectoryPtr>* pieces) {
  const auto kind =
      f.NeedWord("kind", {"hold", "move", "ramps", "sine", "chirp", "multisine"}, "of the piece");
  const auto go = [&](MoveConfig c, double to_rad) {
    c.from_rad = *position;
    c.to_rad = to_rad;
    if (c.to_rad != c.from_rad) pieces->push_back(std::make_shared<Move>(c));
    *position = to_rad;
  };
  double duration_s = 1.0, fade_s = 1.0;
  if (const auto timed = kind.Is({"hold", "sine", "chirp", "multisine"})) {
    f.Need("duration_s", duration_s, kPositive, "of the piece");
  }
  if (kind.word == "hold") pieces->push_back(std::make_shared<Hold>(*position, duration_s));
  MoveConfig move;
  if (const auto moves = kind.Is({"move", "ramps"})) Describe(f, move);
  if (const auto moves = kind.Is({"move"})) {
    double to_rad = 0.0;
    f.Need("~to_rad", to_rad, "where it ends");
    go(move, to_rad);
  }
  if (const auto ramps = kind.Is({"ramps"})) {  // back to the position at the end
    double amplitude = 0.0;
    int cycles = 1;
    f.Need("~amplitude_rad", amplitude, kPositive, "up, then down, around the position");
    f("cycles", cycles, {1, 10000}, "ups and downs");
    const double center = *position;
    for (int i = 0; i < cycles; ++i) {
      go(move, center + amplitude);
      go(move, center - amplitude);
    }
    go(move, center);
  }
  if (const auto faded = kind.Is({"sine", "chirp", "multisine"})) {
    Described wave{.make = nullptr, .center_rad = *position};
    f("fade_s", fade_s, kPositive, "faded in and out in this time");
    DescribeWave(f, kind, kind.word == "chirp" ? duration_s : kEndless, &wave);
    f.Require(2.0 * fade_s <= duration_s, "fade_s",
              "two fades do not fit in duration_s, expected at most half of it");
    f.Check("kind", [&] {
      pieces->push_back(std::make_shared<Windowed>(wave.make(), *position, duration_s, fade_s));
    });
  }
}

static Described DescribeStep(config::Fields& f) {
  StepConfig c;
  std::optional<double> duration_s;
  f("~from_rad", c.from_rad, "before the step");
  f.Need("~to_rad", c.to_rad, "after it");
  c.step_at_s = 1.0;
  f("step_at_s", c.step_at_s, kNotNegative, "when it begins");
  f("rise_s", c.rise_s, kNotNegative, "0: at once");
  f("duration_s", duration_s, kPositive, "left out: endless");
  c.duration_s = duration_s.value_or(c.duration_s);
  return {.make = [c] { return std::make_shared<Step>(c); },
          .center_rad = c.from_rad,
          .horizon_s = c.step_at_s + c.rise_s + 1.0};
}

static Described DescribeCsv(config::Fields& f) {
  std::filesystem::path path;
  std::string time_column = "time_s", position_column = f.Key("~position_rad");
  double sign = 1.0, offset = 0.0;
  f.Need("path", path, "CSV file with a header line");
  f("time_column", time_column, "its name in the header");
  f("position_column", position_column, "the same");
  f("sign", sign, {-1.0, 1.0}, "of the column");
  f("~offset_rad", offset, "added to it");
  if (!f.reads()) return {};
  CsvTrajectory csv = ReadTrajectoryCsv(path, time_column, position_column);
  for (double& q : csv.position_rad) q = sign * q + offset;
  try {
    auto samples = std::make_shared<Samples>(std::move(csv.time_s), std::move(csv.position_rad));
    return {.make = [samples] { return samples; }, .center_rad = samples->At(0.0).position_rad};
  } catch (const std::invalid_argument& error) {
    throw UsageError(path.string() + ": " + error.what() +
                     ", expected two or more rows with rising time");
  }
}

static Described DescribeTrajectory(config::Fields& f) {
  Described out;
  const auto kind = f.NeedWord(
      "kind", {"hold", "sine", "chirp", "step", "multisine", "sequence", "file"}, "of trajectory");
  if (const auto sequence = kind.Is({"sequence"})) {
    std::vector<TrajectoryPtr> pieces;
    f("~start_rad", out.center_rad, "where the first piece begins");
    double position = out.center_rad;
    f.NeedList("pieces", {1}, "each begins where the one before ended, at rest",
               [&](config::Fields& piece) { DescribePiece(piece, &position, &pieces); });
    out.make = [pieces] { return std::make_shared<Sequence>(pieces); };
  }
  if (const auto file = kind.Is({"file"})) out = DescribeCsv(f);
  if (const auto step = kind.Is({"step"})) out = DescribeStep(f);
  if (const auto around = kind.Is({"hold", "sine", "chirp", "multisine"})) {
    std::optional<double> given_s;
    f("~center_rad", out.center_rad, "of the motion");
    f("duration_s", given_s, kPositive, "left out: endless");
    const double duration_s = given_s.value_or(kEndless);
    out.make = [center = out.center_rad, duration_s] {
      return std::make_shared<Hold>(center, duration_s);
    };
    DescribeWave(f, kind, duration_s, &out);
  }
  return out;
}

// The trajectory inside its limits, drawn in where that is allowed; a note says so. Throws
// std::invalid_argument.
static TrajectoryPtr KeepLimits(const Described& described, const Limits& limits, bool may_scale,
                                std::size_t index, const char* unit,
                                std::vector<std::string>* notes) {
  TrajectoryPtr trajectory = described.make();
  const Extremes extremes = Measure(*trajectory, described.horizon_s);
  const double factor = FittingFactor(extremes, described.center_rad, limits);
  if (factor >= 1.0) return trajectory;
  const std::string demand =
      types::Text("position %.4g to %.4g %s, velocity %.4g %s/s, acceleration %.4g %s/s2",
                  extremes.position_lower_rad, extremes.position_upper_rad, unit,
                  extremes.velocity_rad_s, unit, extremes.acceleration_rad_s2, unit);
  if (!may_scale) {
    throw std::invalid_argument("the trajectory asks for " + demand +
                                ", expected one inside the limits (or when_exceeded: scale)");
  }
  notes->push_back(
      types::Text("joint %zu: drawn in to %.4g of its size to keep the limits (asked for %s)",
                  index, factor, demand.c_str()));
  return std::make_shared<Scaled>(trajectory, described.center_rad, factor);
}

static void DescribeJoint(config::Fields& f, LoadedReference* loaded) {
  bool linear = false, may_scale = false;
  f.Word("joint", linear, {{"rotary", false}, {"linear", true}}, "units of the keys: rad or m");
  f.set_linear(linear);
  GeneratorConfig joint;
  f("soft_start_s", joint.soft_start_s, kNotNegative, "from the measured position onto the motion");
  f("soft_stop_s", joint.soft_stop_s, kNotNegative, "at the end, to rest");
  const Described trajectory = DescribeTrajectory(f);
  Limits& l = joint.limits;
  f.Object("limits", "checked over the whole trajectory; left out: none", [&](config::Fields& g) {
    g("~position_lower_rad", l.position_lower_rad, "lowest");
    g("~position_upper_rad", l.position_upper_rad, "highest");
    g("~velocity_rad_s", l.velocity_rad_s, kPositive, "largest");
    g("~acceleration_rad_s2", l.acceleration_rad_s2, kPositive, "largest");
    g.Word("when_exceeded", may_scale, {{"refuse", false}, {"scale", true}},
           "refuse: an error; scale: drawn in towards the centre");
    g.Require(l.position_lower_rad < l.position_upper_rad, "~position_lower_rad",
              "is not below position_upper, expected lower < upper");
  });
  f.Check("limits", [&] {
    joint.trajectory = KeepLimits(trajectory, l, may_scale, loaded->config.joints.size(),
                                  linear ? "m" : "rad", &loaded->notes);
  });
  loaded->config.joints.push_back(joint);
}

void Describe(config::Fields& f, LoadedReference& loaded) {
  f.Word("start", loaded.config.start,
         {{"armed", StartRule::kArmed}, {"operator", StartRule::kOperator}},
         "after arming, or after the operator's start");
  f("start_delay_s", loaded.config.start_delay_s, kNotNegative, "after arming");
  f("hold_s", loaded.config.hold_s, kNotNegative,
    "at the positions of the start, before the soft start");
  const bool squat = f.If("squat", "of a robot with two legs, in place of joints",
                          [&](config::Fields& s) { DescribeSquat(s, &loaded); });
  if (f.reads() && squat && f.section().Has("joints")) {
    f.Fail("joints", "and 'squat' are there, expected one of them");
  }
  if (f.reads() && squat) return;
  const auto joint = [&](config::Fields& g) { DescribeJoint(g, &loaded); };
  f.List("joints", {1, types::kMaxJoints}, "one a joint, in the order of the topics", joint);
  f.Require(!loaded.config.joints.empty(), "joints", "missing, expected a list of mappings");
}

LoadedReference LoadReference(const std::filesystem::path& path) {
  return config::Read<LoadedReference>(config::Section::Load(path, kSchema));
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
