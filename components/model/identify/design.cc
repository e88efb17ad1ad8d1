#include "components/model/identify/design.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/base/types/angle.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/statistics.h"

namespace sinew::identify {

namespace {
// Drive input that the model needs for the motion of a segment.
struct Drive {
  Eigen::VectorXd input;
  Eigen::Index beyond = 0;  // rows whose torque no input gives
};
Drive RequiredDrive(const actuator::JointModel& model, const StateSegment& segment) {
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  Drive out{.input = Eigen::VectorXd(segment.size())};
  model.ResetMemory(segment.samples.front(), memory);
  for (Eigen::Index i = 0; i < segment.size(); ++i) {
    const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
    if (i > 0) model.Advance(x, segment.period_s, memory);
    bool reached = true;
    out.input[i] = model.RequiredDriveInput(x, memory, &reached);
    out.beyond += reached ? 0 : 1;
  }
  return out;
}

// Gain of the low-pass of the angles, a Butterworth forward and backward, at a frequency.
double PassedTwice(double frequency_Hz, const ProcessingOptions& options) {
  return 1.0 / (1.0 + std::pow(std::abs(frequency_Hz) / options.state_cutoff_Hz,
                               2.0 * options.state_order));
}

// Rows of a segment without which its drive keeps the rate that was measured.
constexpr Eigen::Index kLeastForRate = 9;

// Its running integral by the trapezoid rule, 0 at the first row.
void Integrate(double period_s, Eigen::Ref<Eigen::VectorXd> rate) {
  double sum = 0.0;
  double before = rate[0];
  for (Eigen::Index i = 0; i < rate.size(); ++i) {
    const double now = rate[i];
    sum += i > 0 ? 0.5 * period_s * (before + now) : 0.0;
    before = now;
    rate[i] = sum;
  }
}

}  // namespace

std::vector<Eigen::Index> Rows::UsedRows() const {
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < size(); ++i) {
    if (used[static_cast<std::size_t>(i)]) out.push_back(i);
  }
  return out;
}

Design::Design(StateSet states, const ProcessingOptions& options)
    : states_(std::move(states)), options_(options) {
  if (!states_.segments.empty()) {
    const StateSegment& first = states_.segments.front();
    rows_per_s_ = 1.0 / (first.period_s * static_cast<double>(Step(first)));
  }
  std::vector<double> time;
  for (std::size_t s = 0; s < states_.segments.size(); ++s) {
    const StateSegment& segment = states_.segments[s];
    const Eigen::Index step = Step(segment);
    for (Eigen::Index i = step / 2; i < segment.size(); i += step) {
      const auto k = static_cast<std::size_t>(i);
      time.push_back(segment.samples[k].time_s);
      rows_.run.push_back(segment.run);
      rows_.segment.push_back(static_cast<int>(s));
      rows_.used.push_back(segment.usable[k]);
      rows_.sample.push_back(i);
      if (!segment.window.empty()) rows_.window.push_back(segment.window[k]);
    }
  }
  rows_.time_s =
      Eigen::Map<const Eigen::VectorXd>(time.data(), static_cast<Eigen::Index>(time.size()));
  if (options_.raw) return;
  // An unloaded load cell would add its noise to the balance, so it is replaced by its mean.
  states_.silent_load =
      NoiseShare([](const effects::JointSample& x) { return x.load_force_N; }) > kMostNoise;
  if (!states_.silent_load) return;
  for (StateSegment& segment : states_.segments) {
    double mean = 0.0;
    for (const effects::JointSample& x : segment.samples) mean += x.load_force_N;
    mean /= static_cast<double>(segment.size());
    for (effects::JointSample& x : segment.samples) x.load_force_N = mean;
  }
}

Eigen::Index Design::Step(const StateSegment& segment) const {
  if (segment.held) return 1;
  return std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(
             std::floor(0.25 / (segment.period_s * options_.parallel_cutoff_Hz) + 1e-9)));
}

Eigen::Index Design::Thin(const StateSegment& segment, const Eigen::VectorXd& full,
                          Eigen::Ref<Eigen::VectorXd> out) const {
  const double rate = 1.0 / segment.period_s;
  const Eigen::Index step = Step(segment);
  const auto thin = [&](const Eigen::VectorXd& x) {
    Eigen::Index row = 0;
    for (Eigen::Index i = step / 2; i < x.size(); i += step) out[row++] = x[i];
    return row;
  };
  if (segment.held) return thin(full);
  return thin(Smooth(full, options_.parallel_order, options_.parallel_cutoff_Hz, rate));
}

Eigen::MatrixXd Design::Columns(const effects::Effect& effect, std::span<const double> psi) const {
  const effects::EffectInfo& info = effect.info();
  const auto reads = [&](std::string_view field) {
    return std::ranges::count(info.needs, field) + std::ranges::count(info.may_read, field) > 0;
  };
  if (info.event || info.role == effects::Role::kDrive || reads("drive_input") ||
      reads("drive_rate")) {
    return MakeColumns(effect, psi);
  }
  const auto [at, fresh] =
      made_.try_emplace(Made{info.name, info.balance, std::vector<double>(psi.begin(), psi.end())},
                        Eigen::MatrixXd());
  if (fresh) at->second = MakeColumns(effect, psi);
  return at->second;
}

Eigen::MatrixXd Design::MakeColumns(const effects::Effect& effect,
                                    std::span<const double> psi) const {
  const auto count = static_cast<Eigen::Index>(effect.info().linear.size());
  Eigen::MatrixXd out(rows_.size(), count);
  std::array<double, effects::kMaxParameters> phi{};
  std::array<double, effects::kMaxParameters> memory{};
  const std::span<double> memory_span(memory.data(),
                                      static_cast<std::size_t>(effect.memory_size()));
  const std::span<double> phi_span(phi.data(), static_cast<std::size_t>(count));
  Eigen::Index at = 0;
  for (const StateSegment& segment : states_.segments) {
    Eigen::MatrixXd full(segment.size(), count);
    effect.ResetMemory(segment.samples.front(), psi, memory_span);
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
      if (i > 0) effect.Advance(x, segment.period_s, psi, memory_span);
      effect.Regressors(x, psi, memory_span, phi_span);
      for (Eigen::Index c = 0; c < count; ++c) full(i, c) = phi[static_cast<std::size_t>(c)];
    }
    // An effect that repeats faster than the low-pass of the angles is answered by an acceleration
    // that they do not show. By its frequency there: rows are too few to filter what they alias.
    if (options_.raw && effect.info().ripple && !segment.held) {
      const bool of_motor = *effect.info().ripple == effects::Side::kMotor;
      for (Eigen::Index i = 0; i < segment.size(); ++i) {
        const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
        const double turning = of_motor ? x.motor_velocity_rad_s : x.velocity_rad_s;
        full.row(i) *= PassedTwice(psi[0] * turning / types::kTwoPi, options_);
      }
    }
    Eigen::Index rows = 0;
    for (Eigen::Index c = 0; c < count; ++c) {
      if (effect.info().rate) Integrate(segment.period_s, full.col(c));
      rows = Thin(segment, full.col(c), out.col(c).segment(at, rows_.size() - at));
    }
    at += rows;
  }
  for (Eigen::Index c = 0; c < count; ++c) Centre(out.col(c));
  return out;
}

Eigen::VectorXd Design::ThroughFilter(const std::vector<Eigen::VectorXd>& per_segment) const {
  Eigen::VectorXd out(rows_.size());
  Eigen::Index at = 0;
  for (std::size_t s = 0; s < states_.segments.size(); ++s) {
    at += Thin(states_.segments[s], per_segment.at(s), out.segment(at, rows_.size() - at));
  }
  return out;
}

Eigen::MatrixXd Design::RigidColumns() const {
  Eigen::MatrixXd out(rows_.size(), states_.rigid_spread.size());
  std::vector<Eigen::VectorXd> column(states_.segments.size());
  for (Eigen::Index c = 0; c < out.cols(); ++c) {
    for (std::size_t s = 0; s < column.size(); ++s) {
      column[s] = states_.segments[s].rigid_columns.col(c);
    }
    out.col(c) = ThroughFilter(column);
  }
  return out;
}

Eigen::VectorXd Design::MeasuredDrive(const effects::Effect& drive) const {
  std::vector<Eigen::VectorXd> full;
  for (const StateSegment& segment : states_.segments) {
    full.emplace_back(segment.size());
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      effects::JointSample x = segment.samples[static_cast<std::size_t>(i)];
      x.drive_input = segment.drive_input[i];
      drive.Regressors(x, {}, {}, {&full.back()[i], 1});
    }
  }
  Eigen::VectorXd out = ThroughFilter(full);
  Centre(out);
  return out;
}

void Design::Centre(Eigen::Ref<Eigen::VectorXd> column) const {
  if (rows_.window.empty()) return;
  std::vector<double> sum, count;
  const auto in = [&](Eigen::Index i) { return rows_.window[static_cast<std::size_t>(i)]; };
  for (Eigen::Index i = 0; i < rows_.size(); ++i) {
    if (in(i) < 0 || !rows_.used[static_cast<std::size_t>(i)]) continue;
    const auto w = static_cast<std::size_t>(in(i));
    if (sum.size() <= w) {
      sum.resize(w + 1, 0.0);
      count.resize(w + 1, 0.0);
    }
    sum[w] += column[i];
    count[w] += 1.0;
  }
  for (Eigen::Index i = 0; i < rows_.size(); ++i) {
    if (in(i) < 0) continue;
    const auto w = static_cast<std::size_t>(in(i));
    if (w < sum.size() && count[w] > 0.0) column[i] -= sum[w] / count[w];
  }
}

void Design::PredictDrive(const actuator::JointModel& model) {
  if (states_.locked) return;  // the drive has no part in that balance
  // A drive that acts late acts at the rate of what is needed, not of what is asked for early.
  actuator::JointModel prompt = model;
  const bool late = std::erase_if(prompt.terms, [](const actuator::Term& term) {
                      return term.effect->info().follows_record;
                    }) > 0;
  Eigen::Index beyond = 0, rows = 0;
  for (StateSegment& segment : states_.segments) {
    const bool predicted = predicted_rate_ && !segment.held && segment.size() >= kLeastForRate;
    // Nothing else reads the rate: without what follows it, one prediction gives both.
    Drive drive;
    if (predicted || !late) drive = RequiredDrive(prompt, segment);
    const Eigen::VectorXd rate =
        predicted ? WideDifference(drive.input, segment.period_s) : segment.drive_rate;
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      segment.samples[static_cast<std::size_t>(i)].drive_rate = rate[i];
    }
    if (late) drive = RequiredDrive(model, segment);
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      segment.samples[static_cast<std::size_t>(i)].drive_input = drive.input[i];
    }
    beyond += drive.beyond;
    rows += segment.size();
  }
  beyond_drive_ = rows > 0 ? static_cast<double>(beyond) / static_cast<double>(rows) : 0.0;
}

double Design::NoiseShare(const std::vector<Eigen::VectorXd>& full,
                          const Eigen::VectorXd& filtered) const {
  const std::vector<Eigen::Index> used = rows_.UsedRows();
  if (used.empty()) return 1.0;
  double mean = 0.0;
  for (const Eigen::Index i : used) mean += filtered[i] / static_cast<double>(used.size());
  double power = 0.0;
  for (const Eigen::Index i : used) {
    power += (filtered[i] - mean) * (filtered[i] - mean) / static_cast<double>(used.size());
  }
  if (!(power > 0.0)) return 1.0;
  const double sigma = WhiteNoise(full);
  const double nyquist_Hz = 0.5 / states_.segments.front().period_s;
  const double passed = std::min(1.0, options_.parallel_cutoff_Hz / nyquist_Hz);
  return std::min(1.0, sigma * sigma * passed / power);
}

void Design::SetMotorTurn(int run, double turn_rad) {
  made_.clear();
  for (StateSegment& segment : states_.segments) {
    if (segment.run != run) continue;
    for (effects::JointSample& x : segment.samples) x.motor_turn_rad = turn_rad;
  }
}

void Design::SetClock(int run, const std::vector<double>& instants_s, double clock_s) {
  const double offset_s = instants_s.empty() ? kLongBefore : clock_s - instants_s.front();
  for (StateSegment& segment : states_.segments) {
    if (segment.run != run) continue;
    std::size_t next = 0;
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      const double time_s = segment.start_s + segment.period_s * static_cast<double>(i);
      while (next + 1 < instants_s.size() &&
             time_s > 0.5 * (instants_s[next] + instants_s[next + 1])) {
        ++next;
      }
      segment.samples[static_cast<std::size_t>(i)].time_s =
          instants_s.size() < 2 ? time_s + offset_s : time_s + clock_s - instants_s[next];
    }
  }
}

}  // namespace sinew::identify
