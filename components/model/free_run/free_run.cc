#include "components/model/free_run/free_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace sinew::free_run {

namespace {

using identify::StateSegment;

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  // Further away than the motion is wide: gone.
  bool Lost(double position) const {
    const double width = upper - lower;
    return !(position > lower - width && position < upper + width);
  }
};

Range RangeOf(const StateSegment& segment) {
  Range range;
  for (const effects::JointSample& x : segment.samples) {
    range.lower = std::min(range.lower, x.position_rad);
    range.upper = std::max(range.upper, x.position_rad);
  }
  return range;
}

// Positions of a simulated piece: NaN behind the sample where it was lost or where nothing was
// simulated.
struct Path {
  std::vector<double> position;
  int pieces = 0, diverged = 0;
};

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

Path ClosedLoop(Simulation& simulation, const StateSegment& segment, const actuator::Servo& servo,
                double gain) {
  Path path;
  path.pieces = 1;
  path.position.assign(segment.samples.size(), kNothing);
  const Range range = RangeOf(segment);
  simulation.WarmUp(segment, 0, 0);
  simulation.Start(segment.samples.front());
  path.position.front() = segment.samples.front().position_rad;
  for (Eigen::Index i = 0; i + 1 < segment.size(); ++i) {
    simulation.Advance(segment, i, {&servo, gain});
    if (range.Lost(simulation.position_rad())) {
      path.diverged = 1;
      std::fill(path.position.begin(), path.position.end(), kNothing);
      return path;
    }
    path.position[static_cast<std::size_t>(i + 1)] = simulation.position_rad();
  }
  return path;
}

Path Horizons(Simulation& simulation, const StateSegment& segment, double horizon_s) {
  Path path;
  path.position.assign(segment.samples.size(), kNothing);
  const Range range = RangeOf(segment);
  const auto length = std::max<Eigen::Index>(
      2, static_cast<Eigen::Index>(std::lround(horizon_s / segment.period_s)));
  Eigen::Index warm = 0;
  for (Eigen::Index from = 0; from + length <= segment.size(); from += length) {
    const auto first = segment.valid.begin() + from;
    if (std::count(first, first + length, 0) != 0) continue;  // rows were lost inside
    ++path.pieces;
    simulation.WarmUp(segment, warm, from);
    warm = from;
    simulation.Start(segment.samples[static_cast<std::size_t>(from)]);
    for (Eigen::Index i = from; i + 1 < from + length; ++i) {
      simulation.Advance(segment, i, {});
      if (range.Lost(simulation.position_rad())) {
        ++path.diverged;
        std::fill(path.position.begin() + from, path.position.begin() + i + 1, kNothing);
        break;
      }
      path.position[static_cast<std::size_t>(i + 1)] = simulation.position_rad();
    }
  }
  return path;
}

// Sums over samples that count for all models, so that they are compared on the same ones.
struct Sums {
  double absolute = 0.0, squared = 0.0, count = 0.0;
  void Add(double error) {
    absolute += std::abs(error);
    squared += error * error;
    count += 1.0;
  }
  void Add(const Sums& other) {
    absolute += other.absolute;
    squared += other.squared;
    count += other.count;
  }
  double mean() const { return count > 0.0 ? absolute / count : 0.0; }
  double rms() const { return count > 0.0 ? std::sqrt(squared / count) : 0.0; }
};

// Errors over the samples that all models reached which did not run away for the most part: a model
// is not the better for the samples that it lost.
void SumErrors(const std::vector<Trace>& traces, FreeRun* free) {
  const auto lost = [](const ModelError& model) { return 2 * model.diverged > model.pieces; };
  const std::size_t count = free->models.size();
  std::vector<std::vector<Sums>> sums(count, std::vector<Sums>(free->models.front().runs.size()));
  for (const Trace& trace : traces) {
    for (std::size_t i = 0; i < trace.measured.size(); ++i) {
      bool reached = true;
      for (std::size_t m = 0; m < count; ++m) {
        reached = reached && (lost(free->models[m]) || std::isfinite(trace.simulated[m][i]));
      }
      for (std::size_t m = 0; reached && m < count; ++m) {
        if (lost(free->models[m])) continue;
        sums[m][static_cast<std::size_t>(trace.run)].Add(trace.simulated[m][i] - trace.measured[i]);
      }
    }
  }
  for (std::size_t m = 0; m < count; ++m) {
    ModelError& model = free->models[m];
    Sums all;
    for (std::size_t r = 0; r < model.runs.size(); ++r) {
      model.runs[r].mean_abs = sums[m][r].mean();
      model.runs[r].rms = sums[m][r].rms();
      model.runs[r].samples = sums[m][r].count;
      all.Add(sums[m][r]);
    }
    model.mean_abs = all.count > 0.0 ? all.mean() : kNothing;
    model.rms = all.count > 0.0 ? all.rms() : kNothing;
  }
}

}  // namespace

FreeRunResult Compare(const std::vector<types::Run>& runs,
                      const std::vector<actuator::JointModel>& models,
                      const identify::ProcessingOptions& processing, const MakeBody& make_body,
                      const FreeRunOptions& options) {
  FreeRunResult out;
  const identify::StateSet states = identify::MakeStates(runs, models.back(), processing);
  std::vector<Simulation> simulations;
  try {
    for (const actuator::JointModel& model : models)
      simulations.emplace_back(model, make_body, options.step_s);
  } catch (const std::invalid_argument& error) {
    out.why_not = std::string("the model cannot be simulated: ") + error.what();
    return out;
  }
  const std::optional<actuator::Servo>& servo = models.back().controller;
  const std::vector<double> gains = ServoGains(states.segments, servo);
  const bool closed = !gains.empty();
  FreeRun free;
  free.method = closed ? Method::kClosedLoop : Method::kHorizons;
  free.horizon_s = closed ? 0.0 : options.horizon_s;
  free.models.resize(models.size());
  for (ModelError& model : free.models) {
    for (const std::string& name : states.run_names) model.runs.push_back({.run = name});
  }
  for (std::size_t s = 0; s < states.segments.size(); ++s) {
    const StateSegment& segment = states.segments[s];
    Trace trace;
    trace.run = segment.run;
    trace.start_s = segment.start_s;
    trace.period_s = segment.period_s;
    for (const effects::JointSample& x : segment.samples) trace.measured.push_back(x.position_rad);
    for (std::size_t m = 0; m < models.size(); ++m) {
      Path path = closed ? ClosedLoop(simulations[m], segment, *servo, gains[s])
                         : Horizons(simulations[m], segment, options.horizon_s);
      ModelError& model = free.models[m];
      RunError& error = model.runs[static_cast<std::size_t>(segment.run)];
      error.pieces += path.pieces;
      error.diverged += path.diverged;
      model.pieces += path.pieces;
      model.diverged += path.diverged;
      if (closed) error.servo_gain = gains[s];
      trace.simulated.push_back(std::move(path.position));
    }
    out.traces.push_back(std::move(trace));
  }
  SumErrors(out.traces, &free);
  if (std::none_of(free.models.begin(), free.models.end(),
                   [](const ModelError& model) { return std::isfinite(model.rms); })) {
    out.why_not = "no piece of the recording could be followed by the models";
    return out;
  }
  out.errors = std::move(free);
  return out;
}

FreeRunResult Join(std::vector<FreeRunResult> parts) {
  FreeRunResult out = std::move(parts.front());
  for (std::size_t p = 1; out.errors && p < parts.size(); ++p) {
    if (!parts[p].errors) return std::move(parts[p]);
    for (std::size_t m = 0; m < out.errors->models.size(); ++m) {
      ModelError& model = out.errors->models[m];
      const ModelError& more = parts[p].errors->models[m];
      model.runs.insert(model.runs.end(), more.runs.begin(), more.runs.end());
      model.pieces += more.pieces;
      model.diverged += more.diverged;
      // A model that diverged in one part has no error.
      if (!std::isfinite(more.rms)) model.rms = model.mean_abs = kNothing;
    }
    std::move(parts[p].traces.begin(), parts[p].traces.end(), std::back_inserter(out.traces));
  }
  if (!out.errors) return out;
  for (ModelError& model : out.errors->models) {
    double absolute = 0.0, squared = 0.0, samples = 0.0;
    for (const RunError& run : model.runs) {
      absolute += run.samples * run.mean_abs;
      squared += run.samples * run.rms * run.rms;
      samples += run.samples;
    }
    if (!std::isfinite(model.rms) || !(samples > 0.0)) continue;
    model.mean_abs = absolute / samples;
    model.rms = std::sqrt(squared / samples);
  }
  return out;
}

}  // namespace sinew::free_run
