#include "components/model/shooting/pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "components/model/identify/spectrum.h"
#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/problem.h"
#include "components/model/trace/used_rows.h"

namespace sinew::shooting {

namespace {

using effects::JointSample;
using identify::StateSegment;

constexpr double kStep_s = 1e-3;  // of the plant's integrator
constexpr double kShortest_s = 0.5, kLongest_s = 2.0;
// A deviation of the start may grow tenfold in a piece (an inverted pendulum's does without end);
// in nine of ten pieces.
constexpr double kMostGrowth = 10.0, kGrowthQuantile = 0.9;
// A zero that is set by hand on a joint without gravity: 0.1 rad is seen by eye.
constexpr double kByHand_rad = 0.1;

// One period of the motion, exact for a sine; shorter where the recordings are: twice as many
// pieces as inference needs blocks.
double PieceLength(const std::vector<StateSegment>& segments, const trace::InForce& in_force) {
  double sum = 0.0, squares = 0.0, speeds = 0.0, rows = 0.0, seconds = 0.0;
  for (const StateSegment& segment : segments) {
    for (const JointSample& x : segment.samples) {
      sum += x.position_rad;
      squares += x.position_rad * x.position_rad;
      speeds += x.velocity_rad_s * x.velocity_rad_s;
    }
    rows += static_cast<double>(segment.size());
    seconds += static_cast<double>(segment.size()) * segment.period_s;
  }
  const double variance = std::max(0.0, squares - sum * sum / rows);
  const double period = 2.0 * std::numbers::pi * std::sqrt(variance / std::max(speeds, 1e-300));
  const double most = seconds / (2.0 * in_force.Limit(trace::rules::kBlocks));
  return std::clamp(std::min(period, most), kShortest_s, kLongest_s);
}

// Angle as its encoder gave it, at the output.
Eigen::VectorXd RawAngle(const types::Run& run, const actuator::JointModel& joint) {
  if (run.Has(types::Signal::kPosition)) return run.At(types::Signal::kPosition);
  return run.At(types::Signal::kMotorPosition) / joint.constants.gear_ratio;
}

}  // namespace

identify::ProcessingOptions ProcessingOf(const std::vector<types::Run>& runs,
                                         const actuator::JointModel& joint, double longest_gap_s) {
  identify::ProcessingOptions out = identify::FromMotion(runs, joint, longest_gap_s);
  double band_Hz = 0.0;
  for (const types::Run& run : runs) {
    const identify::UniformRun uniform = identify::MakeUniform(run);
    for (const identify::UniformSegment& segment : uniform.segments) {
      const auto at = segment.signals.find(types::Signal::kPosition);
      if (at == segment.signals.end()) continue;
      band_Hz = std::max(band_Hz,
                         identify::PowerDensity(at->second, segment.rate_Hz()).BandOfLeastError(1));
    }
  }
  out.state_cutoff_Hz = std::max(out.state_cutoff_Hz, band_Hz);
  return out;
}

Recordings::Recordings(const std::vector<types::Run>& runs, const actuator::JointModel& joint,
                       const identify::ProcessingOptions& processing, free_run::MakeBody make_body,
                       const trace::InForce& in_force)
    : design_(identify::MakeStates(runs, joint, processing), processing),
      make_body_(std::move(make_body)),
      servo_(joint.controller) {
  const std::vector<StateSegment>& segments = design_.states().segments;
  gains_ = free_run::ServoGains(segments, servo_);
  trace::UsedRows all;
  all.rows.resize(static_cast<std::size_t>(design_.rows().size()));
  std::iota(all.rows.begin(), all.rows.end(), Eigen::Index{0});
  machine_ = trace::SizeOf(design_, all, joint);
  SetDeviations(runs, joint);
  piece_s_ = PieceLength(segments, in_force);
  Cut();
  while (piece_s_ > kShortest_s && Growth(joint) > kMostGrowth) {
    piece_s_ = std::max(kShortest_s, 0.5 * piece_s_);
    Cut();
  }
  if (pieces_.empty()) throw identify::TooLittleData("no piece of 0.5 s without lost rows");
}

double Recordings::Growth(const actuator::JointModel& joint) const {
  std::vector<double> growth;
  Eigen::VectorXd off = Eigen::VectorXd::Zero(deviation_.size());
  off[0] = kDifference;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const Path path = Simulate(joint, p, Eigen::VectorXd::Zero(off.size()), 0.0);
    const Eigen::VectorXd moved = Simulate(joint, p, off, 0.0).angle - path.angle;
    growth.push_back(std::abs(moved[moved.size() - 1]) / (kDifference * deviation_[0]));
  }
  return identify::Quantile(std::move(growth), kGrowthQuantile);
}

// Pieces of even length between lost rows.
void Recordings::Cut() {
  const std::vector<StateSegment>& segments = design_.states().segments;
  pieces_.clear();
  lowest_.clear();
  highest_.clear();
  std::vector<double> measured;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const StateSegment& segment = segments[s];
    const auto [low, high] = std::minmax_element(
        segment.samples.begin(), segment.samples.end(),
        [](const auto& a, const auto& b) { return a.position_rad < b.position_rad; });
    const double width = high->position_rad - low->position_rad;
    lowest_.push_back(low->position_rad - width);
    highest_.push_back(high->position_rad + width);
    Eigen::Index end = 0;
    for (Eigen::Index begin = 0; begin < segment.size(); begin = end + 1) {
      end = begin;
      while (end < segment.size() && segment.valid[static_cast<std::size_t>(end)] != 0) ++end;
      const Eigen::Index length = end - begin - 1;  // rows, one less than samples
      const double seconds = static_cast<double>(length) * segment.period_s;
      if (seconds < kShortest_s || length < trace::kFewestRowsPerBlock) continue;
      const auto parts = std::max<Eigen::Index>(
          1, static_cast<Eigen::Index>(std::floor(seconds / piece_s_ + 1e-9)));
      for (Eigen::Index p = 0; p < parts; ++p) {
        Piece piece{s,           begin + p * length / parts,
                    0,           static_cast<Eigen::Index>(measured.size()),
                    segment.run, p + 1 < parts};
        piece.count = begin + (p + 1) * length / parts - piece.first;
        for (Eigen::Index i = 1; i <= piece.count; ++i) {
          measured.push_back(
              segment.samples[static_cast<std::size_t>(piece.first + i)].position_rad);
        }
        pieces_.push_back(piece);
      }
    }
  }
  measured_ = Eigen::Map<const Eigen::VectorXd>(measured.data(),
                                                static_cast<Eigen::Index>(measured.size()));
}

void Recordings::SetDeviations(const std::vector<types::Run>& runs,
                               const actuator::JointModel& joint) {
  std::vector<Eigen::VectorXd> raw;
  double step = 0.0;
  for (const types::Run& run : runs) {
    raw.push_back(RawAngle(run, joint));
    step = std::max(step, identify::Resolution(raw.back()));
  }
  const double sensor = std::max(identify::WhiteNoise(raw), step / std::sqrt(12.0));
  // Behind the low-pass: flat noise, and that of its derivative.
  const double band_Hz = design_.options().state_cutoff_Hz;
  const double share = std::min(1.0, 2.0 * band_Hz / design_.states().rate_Hz);
  const double lag_s = 1.0 / (2.0 * std::numbers::pi * band_Hz);
  noise_rad_ = std::max(sensor * std::sqrt(share), 1e-9);
  const double jump =
      identify::Rms(design_.Variable([](const JointSample& x) { return x.acceleration_rad_s2; }));
  const double position = std::hypot(noise_rad_, 0.125 * jump * lag_s * lag_s);
  const double velocity = std::hypot(noise_rad_ / (lag_s * std::sqrt(3.0)), 0.25 * jump * lag_s);
  const double play = joint.backlash_rad;
  const bool seen = design_.states().measured.contains("motor_position_rad");
  deviation_.resize(play > 0.0 ? 4 : 2);
  deviation_.head<2>() << position, velocity;
  if (play > 0.0) {
    deviation_.tail<2>() << (seen ? position : play / std::sqrt(12.0)), velocity;
  }
  // A link that hangs is at rest within its friction over gravity.
  const int gravity = joint.Find("gravity");
  const double friction = trace::DryFriction(joint);
  double by_hand = kByHand_rad;
  if (gravity >= 0 && friction > 0.0) {
    const double torque =
        std::abs(joint.terms[static_cast<std::size_t>(gravity)].linear.front().value);
    by_hand = friction / std::max(torque, friction / kByHand_rad);
  }
  zero_deviation_.resize(static_cast<Eigen::Index>(runs.size()));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    zero_deviation_[static_cast<Eigen::Index>(r)] =
        runs[r].zero_unknown.contains(types::Signal::kPosition) ? by_hand : 0.0;
  }
}

Start Recordings::Measured() const {
  return {Eigen::MatrixXd::Zero(deviation_.size(), static_cast<Eigen::Index>(pieces_.size())),
          Eigen::VectorXd::Zero(zero_deviation_.size())};
}

Path Recordings::Simulate(const actuator::JointModel& model, std::size_t piece,
                          const Eigen::Ref<const Eigen::VectorXd>& state, double zero_rad) const {
  const Piece& p = pieces_[piece];
  const StateSegment& segment = design_.states().segments[p.segment];
  const double ratio = model.constants.gear_ratio;
  const Eigen::VectorXd off = state.cwiseProduct(deviation_);
  JointSample x = segment.samples[static_cast<std::size_t>(p.first)];
  x.position_rad += zero_rad + off[0];
  x.velocity_rad_s += off[1];
  x.motor_position_rad += ratio * (zero_rad + off[0]);
  x.motor_velocity_rad_s += ratio * off[1];
  if (off.size() > 2) {
    x.motor_position_rad += ratio * off[2];
    x.motor_velocity_rad_s += ratio * off[3];
  }
  free_run::Simulation simulation(model, make_body_, kStep_s);
  simulation.WarmUp(segment, 0, p.first);
  simulation.Start(x);
  free_run::Mover mover{nullptr, 0.0, zero_rad};
  if (closed_loop()) mover = {&*servo_, gains_[p.segment], zero_rad};
  Path path;
  path.angle.resize(p.count);
  for (Eigen::Index i = 0; i < p.count; ++i) {
    simulation.Advance(segment, p.first + i, mover);
    const double angle = simulation.position_rad() - zero_rad;
    path.angle[i] = std::clamp(angle, lowest_[p.segment], highest_[p.segment]);
    if (path.angle[i] == angle) continue;
    path.angle.tail(p.count - i)
        .setConstant(angle > 0.0 ? highest_[p.segment] : lowest_[p.segment]);
    return path;
  }
  path.end_velocity = simulation.velocity_rad_s();
  return path;
}

Eigen::VectorXd Recordings::Stacked(const actuator::JointModel& model, const Start& start) const {
  const auto gaps = std::count_if(pieces_.begin(), pieces_.end(),
                                  [](const Piece& piece) { return piece.continues; });
  Eigen::VectorXd out(rows() + 2 * gaps);
  Eigen::Index gap = rows();
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const auto c = static_cast<Eigen::Index>(p);
    const Path path = Simulate(model, p, start.state.col(c), start.zero_rad[pieces_[p].run]);
    out.segment(pieces_[p].row, pieces_[p].count) = path.angle;
    if (!pieces_[p].continues) continue;
    out.segment<2>(gap) = Gap(p, path, start.state.col(c + 1));
    gap += 2;
  }
  return out;
}

Eigen::Vector2d Recordings::Gap(std::size_t piece, const Path& path,
                                const Eigen::Ref<const Eigen::VectorXd>& next_state) const {
  const Piece& p = pieces_[piece];
  const JointSample& x =
      design_.states().segments[p.segment].samples[static_cast<std::size_t>(p.first + p.count)];
  return {(path.angle[p.count - 1] - x.position_rad) / deviation_[0] - next_state[0],
          (path.end_velocity - x.velocity_rad_s) / deviation_[1] - next_state[1]};
}

}  // namespace sinew::shooting
