#include "components/model/identify/gas.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

namespace {

constexpr double kBar_Pa = 1e5;
constexpr double kSmallestStep_bar = 0.1;  // an opening that moves the pressure less shows nothing

bool Reads(const effects::EffectInfo& info, const char* field) {
  return std::find(info.needs.begin(), info.needs.end(), field) != info.needs.end();
}

// Course of the pressure after an opening: level + slope s + bend s^2, s = time since it began.
struct Opening {
  std::size_t segment = 0;
  Eigen::Index begin = 0, end = 0, stays = 0;  // rows: of the window, and the last one open
  double command_s = 0.0, dead_s = 0.0;        // when the flow should begin, how much later it did
  double slope = 0.0, bend = 0.0;
  double Flow(double s) const { return s > 0.0 ? (slope + bend * s) * s : 0.0; }
  double Rate(double s) const { return s > 0.0 ? slope + 2.0 * bend * s : 0.0; }
};

// Fits the curve and ends the window kAfterOpening_s after its beginning.
void FitOpening(const UniformSegment& piece, const Eigen::VectorXd& pressure, Eigen::Index last,
                Opening* opening) {
  const double period_s = piece.period_s;
  const Eigen::Index before = last - opening->begin + 1;
  const double level = pressure.segment(opening->begin, before).mean();
  // The flow has surely begun where the pressure has left its level by half of the smallest step.
  Eigen::Index moved = last + 1;
  while (moved < opening->stays && std::abs(pressure[moved] - level) < 0.5 * kSmallestStep_bar) {
    ++moved;
  }
  const double latest_s =
      std::min(kLongestDeadTime_s, piece.Time(moved) - opening->command_s + period_s);
  opening->end = std::min(
      opening->stays, moved + static_cast<Eigen::Index>(std::lround(kAfterOpening_s / period_s)));
  const Eigen::Index n = opening->end - opening->begin + 1;
  const Eigen::VectorXd y = pressure.segment(opening->begin, n);
  double least = std::numeric_limits<double>::infinity();
  for (double dead = -0.5 * period_s; dead <= latest_s; dead += 0.1 * period_s) {
    Eigen::MatrixXd columns(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = std::max(0.0, piece.Time(opening->begin + i) - opening->command_s - dead);
      columns.row(i) << 1.0, s, s * s;
    }
    const Eigen::VectorXd b = columns.colPivHouseholderQr().solve(y);
    const double error = (y - columns * b).squaredNorm();
    if (error >= least) continue;
    least = error;
    opening->slope = b[1];
    opening->bend = b[2];
    opening->dead_s = dead;
  }
}

// Writes the flow into the samples, each opening's from its command on.
void PlayOpenings(const std::vector<Opening>& openings, StateSet* states) {
  if (openings.empty()) return;
  std::vector<double> dead;
  dead.reserve(openings.size());
  for (const Opening& opening : openings) dead.push_back(opening.dead_s);
  const double middle_s = Quantile(std::move(dead), 0.5);
  for (const Opening& opening : openings) {
    StateSegment& segment = states->segments[opening.segment];
    // A delay common to all is a dead time only where it is longer than any opening takes.
    const bool late = std::abs(middle_s) > kOpeningSamples * segment.period_s;
    const double shared_s = late ? 0.0 : middle_s;
    const double between_rows_s =
        shared_s + std::clamp(opening.dead_s - middle_s, -segment.period_s, segment.period_s);
    for (Eigen::Index i = opening.begin; i <= opening.stays; ++i) {
      effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
      const double since = x.time_s - opening.command_s - between_rows_s;
      x.valve_flow_bar = opening.Flow(since);
      x.valve_flow_rate_bar_s = opening.Rate(since);
    }
  }
}

void SetVolumeRates(const actuator::JointModel& model, std::vector<effects::JointSample>* samples) {
  const int stiffness = model.Find("pneumatic_stiffness");
  const double rest_rad =
      stiffness >= 0 ? model.terms[static_cast<std::size_t>(stiffness)].nonlinear[0].value : 0.0;
  // The slope is a straight line for every pneumatic term there is: two values give the volume.
  const double slope_at_rest = ChamberSlope_m3_rad(model, rest_rad);
  const double bend = ChamberSlope_m3_rad(model, rest_rad + 1.0) - slope_at_rest;
  for (effects::JointSample& x : *samples) {
    const double from_rest = x.position_rad - rest_rad;
    const double slope = slope_at_rest + bend * from_rest;
    const double volume =
        model.constants.gas_volume_m3 + (slope_at_rest + 0.5 * bend * from_rest) * from_rest;
    x.volume_rate_1_s = slope * x.velocity_rad_s / volume;
  }
}

}  // namespace

double ChamberSlope_m3_rad(const actuator::JointModel& model, double position_rad) {
  effects::JointSample x;
  x.position_rad = position_rad;
  double torque_Nm_bar = 0.0;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const effects::Effect& effect = *model.terms[t].effect;
    const effects::EffectInfo& info = effect.info();
    if (info.balance != effects::Balance::kMotion || !Reads(info, "pressure_bar") ||
        Reads(info, "velocity_rad_s") || effect.memory_size() > 0) {
      continue;
    }
    for (const double pressure : {1.0, 0.0}) {
      x.pressure_bar = pressure;
      const std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
      const double torque = model.TermTorque(static_cast<int>(t), x, memory);
      torque_Nm_bar += pressure > 0.0 ? torque : -torque;
    }
  }
  return torque_Nm_bar / kBar_Pa;
}

GasWindows MakeGasStates(const std::vector<types::Run>& runs, const actuator::JointModel& fitted,
                         const ProcessingOptions& motion) {
  actuator::JointModel model = fitted;
  model.balance = effects::Balance::kMotion;
  GasWindows out{.states = MakeStates(runs, model, motion)};
  out.states.measured.insert({"volume_rate_1_s", "valve_flow_bar", "valve_flow_rate_bar_s"});

  int window = 0;
  std::size_t s = 0;
  std::vector<Opening> openings;
  for (const types::Run& run : runs) {
    const UniformRun uniform = MakeUniform(run, motion.longest_gap_s);
    for (const UniformSegment& piece : uniform.segments) {
      StateSegment& segment = out.states.segments[s++];
      const Eigen::VectorXd& pressure = piece.signals.at(types::Signal::kChamberPressure);
      segment.drive_input = pressure;
      std::fill(segment.at_rest.begin(), segment.at_rest.end(), 0);
      std::fill(segment.usable.begin(), segment.usable.end(), 0);
      segment.window.assign(segment.samples.size(), -1);
      SetVolumeRates(model, &segment.samples);
      const auto open = [&](Eigen::Index i) {
        return segment.samples[static_cast<std::size_t>(i)].valve_open;
      };
      const auto rows = [&](double seconds) {
        return static_cast<Eigen::Index>(std::lround(seconds / piece.period_s));
      };
      const auto mark = [&](Eigen::Index from, Eigen::Index to) {
        for (Eigen::Index i = from; i <= to; ++i) {
          const auto k = static_cast<std::size_t>(i);
          segment.window[k] = window;
          segment.usable[k] = piece.valid[k];
        }
        ++window;
      };
      for (Eigen::Index first = 0; first < piece.size();) {
        if (open(first)) {
          ++first;
          continue;
        }
        Eigen::Index last = first;
        while (last + 1 < piece.size() && !open(last + 1)) ++last;
        const bool opens = last + 1 < piece.size();
        Eigen::Index from = first + (first > 0 ? rows(kAfterShutting_s) : 0);
        Eigen::Index to = last;
        Eigen::Index stays = last;
        while (stays + 1 < piece.size() && open(stays + 1)) ++stays;
        if (opens && stays - last >= rows(kAfterOpening_s + kLongestDeadTime_s) &&
            last - from >= rows(kBeforeOpening_s)) {
          Opening opening;
          opening.segment = s - 1;
          opening.begin = last - rows(kBeforeOpening_s) + 1;
          opening.stays = stays;
          // Thrown somewhere between two rows.
          opening.command_s =
              piece.Time(last) + 0.5 * piece.period_s + model.constants.valve_delay_s;
          FitOpening(piece, pressure, last, &opening);
          if (std::abs(opening.Flow(kAfterOpening_s)) > kSmallestStep_bar) {
            mark(opening.begin, opening.end);
            to = opening.begin - 1;
            openings.push_back(opening);
          }
        }
        const double span = piece.period_s * static_cast<double>(to - from);
        if (span >= kShortestWindow_s) {
          const auto pieces = static_cast<Eigen::Index>(std::ceil(span / kLongestWindow_s));
          for (Eigen::Index p = 0; p < pieces; ++p) {
            mark(from + p * (to - from + 1) / pieces,
                 from + (p + 1) * (to - from + 1) / pieces - 1);
            ++out.shut;
          }
        }
        first = last + 1;
      }
    }
  }
  PlayOpenings(openings, &out.states);
  out.openings = static_cast<int>(openings.size());
  return out;
}

}  // namespace sinew::identify
