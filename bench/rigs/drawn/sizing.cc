#include "bench/rigs/drawn/sizing.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew::rigs {
namespace {

constexpr int kTraining = kRecordings - 1;

Shows Within(Excitation excitation, Shows shows) {
  return excitation == Excitation::kLocked ? Shows::kLocked : shows;
}

double MeanSquare(const Eigen::VectorXd& x) {
  return x.size() == 0 ? 0.0 : x.squaredNorm() / static_cast<double>(x.size());
}

Eigen::VectorXd Coefficients(const Balance& balance) {
  Eigen::VectorXd scale = balance.columns.colwise().norm().transpose();
  for (Eigen::Index c = 0; c < scale.size(); ++c) scale[c] = scale[c] > 0.0 ? scale[c] : 1.0;
  const Eigen::MatrixXd unit = balance.columns * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd gram = unit.transpose() * unit;
  gram.diagonal().array() += 1e-10;
  return (gram.ldlt().solve(unit.transpose() * balance.response)).cwiseQuotient(scale);
}

Balance Restrict(const Balance& balance, const std::vector<Eigen::Index>& keep) {
  Balance out;
  const auto n = static_cast<Eigen::Index>(keep.size());
  out.response.resize(n);
  out.columns.resize(n, balance.columns.cols());
  out.prior_sd = balance.prior_sd;
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto from = keep[static_cast<std::size_t>(k)];
    out.response[k] = balance.response[from];
    out.columns.row(k) = balance.columns.row(from);
    out.row.push_back(balance.row[static_cast<std::size_t>(from)]);
  }
  return out;
}

}  // namespace

Run Play(const Rig& rig, const std::vector<Effect>& effects, Excitation excitation,
         int recordings) {
  Run run;
  for (int i = 0; i < recordings; ++i) {
    run.rows.push_back(Simulate(rig, effects, Motion(rig, excitation, i)));
  }
  return run;
}

Sizer::Sizer(const Rig& rig, Excitation excitation)
    : rig_(rig), excitation_(excitation), twin_(Play(rig, {}, excitation)) {
  // The kernel that leaves the twin's torque residual smallest: noise of differences against
  // motion.
  double best = 0.0;
  const Shows shows = Within(excitation, Shows::kTorque);
  const double widths[] = {0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
  for (const double width : widths) {
    width_ = width;
    const double now = MeanSquare(RefitResidual(Noisy(twin_, shows, 1)));
    if (best == 0.0 || now < best) {
      best = now;
    } else {
      width_ = 0.5 * width;
      break;
    }
  }
}

Balance Sizer::Clean(const Run& run, Shows shows, int recordings) const {
  std::vector<Balance> parts;
  for (int i = 0; i < recordings; ++i) {
    const auto& rows = run.rows[static_cast<std::size_t>(i)];
    parts.push_back(
        MakeBalance(rig_, ReadExactly(rig_, rows), Usable(rig_, rows, shows), shows, width_, i));
  }
  return Stack(parts);
}

Balance Sizer::Noisy(const Run& run, Shows shows, int recordings) const {
  std::vector<Balance> parts;
  for (int i = 0; i < recordings; ++i) {
    const auto& rows = run.rows[static_cast<std::size_t>(i)];
    parts.push_back(MakeBalance(rig_, ReadWithNoise(rig_, rows, i), Usable(rig_, rows, shows),
                                shows, width_, i));
  }
  return Stack(parts);
}

// What the effect changes in the residual of the declared model at the twin's own parameters.
Sizer::Signature Sizer::SignatureOf(const Balance& with, const Balance& without) const {
  const Eigen::VectorXd theta = Coefficients(without);
  const Eigen::VectorXd a = with.response - with.columns * theta;
  const Eigen::VectorXd b = without.response - without.columns * theta;
  const Common common = CommonRows(with.row, without.row);
  Signature out;
  out.values.resize(static_cast<Eigen::Index>(common.left.size()));
  for (std::size_t k = 0; k < common.left.size(); ++k) {
    out.values[static_cast<Eigen::Index>(k)] = a[common.left[k]] - b[common.right[k]];
    out.row.push_back(with.row[static_cast<std::size_t>(common.left[k])]);
  }
  return out;
}

const Balance& Sizer::TwinBalance(Shows shows, bool noisy) const {
  const auto key = std::make_pair(static_cast<int>(shows), noisy);
  const auto found = twins_.find(key);
  if (found != twins_.end()) return found->second;
  return twins_
      .emplace(key, noisy ? Noisy(twin_, shows, kTraining) : Clean(twin_, shows, kTraining))
      .first->second;
}

// Mean squares of the residuals of a run and its twin, each refitted to itself, on rows of both.
std::pair<double, double> Sizer::Residuals(const Balance& noisy, Shows shows) const {
  const Balance& twin = TwinBalance(shows, true);
  const Common common = CommonRows(noisy.row, twin.row);
  return {MeanSquare(RefitResidual(Restrict(noisy, common.left))),
          MeanSquare(RefitResidual(Restrict(twin, common.right)))};
}

double Sizer::Share(const Run& run, Shows asked) const {
  const Shows shows = Within(excitation_, asked);
  const auto [own, without] = Residuals(Noisy(run, shows, kTraining), shows);
  return own > 0.0 ? 1.0 - without / own : 0.0;
}

Measured Sizer::Measure(const Run& run, Shows asked, bool absorbed) const {
  const Shows shows = Within(excitation_, asked);
  Measured out;
  const Balance noisy = Noisy(run, shows, kTraining);
  const auto [own, without] = Residuals(noisy, shows);
  out.residual_rms = std::sqrt(own);
  out.twin_rms = std::sqrt(without);
  out.share = own > 0.0 ? 1.0 - without / own : 0.0;
  const Signature signature = SignatureOf(Clean(run, shows, kTraining), TwinBalance(shows, false));
  const Common common = CommonRows(noisy.row, signature.row);
  Eigen::VectorXd d(static_cast<Eigen::Index>(common.left.size()));
  for (std::size_t k = 0; k < common.left.size(); ++k) {
    d[static_cast<Eigen::Index>(k)] = signature.values[common.right[k]];
  }
  const Balance both = Restrict(noisy, common.left);
  if (absorbed) {
    // Only what declared parameters take over, held back by their tolerances.
    Balance shift = both;
    shift.response = d;
    d = both.columns * Coefficients(shift);
  }
  out.lambda = Lambda(both, d, true);
  return out;
}

Sizer::Sized Sizer::Size(const Effect& effect, double share) const {
  const EffectInfo& info = FindEffect(effect.name);
  const double largest = LargestSize(rig_, effect.name);
  const bool strong = share > 0.2;
  const double wanted =
      info.absorbed ? (strong ? kStrongLambda : kWeakLambda) : share / (1.0 - share);
  Sized out{effect, {}, false};
  double low = 0.0, high = 0.0;  // sizes on either side
  double size = 0.1 * largest;
  const double sign = effect.size < 0.0 ? -1.0 : 1.0;
  for (int round = 0; round < 8; ++round) {
    out.effect.size = sign * size;
    const Run run = Play(rig_, {out.effect}, excitation_, kTraining);
    double odds = 0.0;
    if (info.absorbed) {
      odds = Measure(run, info.shows, true).lambda;
    } else {
      const double now = Share(run, info.shows);
      odds = now / (1.0 - now);
    }
    out.reached = odds > 0.8 * wanted && odds < 1.25 * wanted;
    if (out.reached) break;
    (odds < wanted ? low : high) = size;
    if (size >= largest && odds < wanted) break;
    double next = odds > 0.0 ? size * std::clamp(std::sqrt(wanted / odds), 0.15, 8.0) : 8.0 * size;
    if (low > 0.0 && high > 0.0 && (next <= low || next >= high)) next = std::sqrt(low * high);
    if (high == 0.0 || next < high)
      size = std::min(next, largest);
    else
      size = low > 0.0 ? std::sqrt(low * high) : 0.3 * high;
  }
  out.measured =
      Measure(Play(rig_, {out.effect}, excitation_, kTraining), info.shows, info.absorbed);
  return out;
}

// Signatures of another effect in the first recording: at a sixth of its largest size and, where it
// has a shape that is no factor, at a third and thrice that shape.
const std::vector<Sizer::Signature>& Sizer::RivalsOf(const std::string& name, Shows shows) const {
  const auto found = rivals_.find(name);
  if (found != rivals_.end()) return found->second;
  const bool by_size =
      name == "presliding" || name == "elastic_joint" || name == "gas_heat_exchange";
  const bool by_shape =
      name == "stribeck" || name == "seal_hysteresis" || name == "stiffness_collapse";
  const Run first{{twin_.rows.front()}};
  const Balance without = Clean(first, shows, 1);
  std::vector<Signature> out;
  for (const double factor : {1.0, 1.0 / 3.0, 3.0}) {
    Effect rival = DrawEffect(rig_, name);
    rival.size = std::copysign(LargestSize(rig_, name) / 6.0, rival.size);
    if (by_size) rival.size *= factor;
    if (by_shape) rival.shape[0] *= factor;
    out.push_back(SignatureOf(Clean(Play(rig_, {rival}, excitation_, 1), shows, 1), without));
    if (!by_size && !by_shape) break;
  }
  return rivals_.emplace(name, std::move(out)).first->second;
}

std::vector<std::string> Sizer::ClassOf(const Effect& effect) const {
  std::vector<std::string> names = {effect.name};
  const EffectInfo& info = FindEffect(effect.name);
  if (info.kind != Kind::kCatalogue || info.absorbed) return names;
  const Shows shows = Within(excitation_, info.shows);
  const Run first{{twin_.rows.front()}};
  const Balance without = Clean(first, shows, 1), noisy = Noisy(first, shows, 1);
  const Eigen::VectorXd ar = FitAr(RefitResidual(noisy), noisy.row, kArOrder);
  const Signature own = SignatureOf(Clean(Play(rig_, {effect}, excitation_, 1), shows, 1), without);
  for (const std::string& name : EffectsOf(rig_, Kind::kCatalogue)) {
    const EffectInfo& other = FindEffect(name);
    if (name == effect.name || other.shows != info.shows || other.absorbed) continue;
    double loss = 1.0;
    for (const Signature& theirs : RivalsOf(name, shows)) {
      const Common common = CommonRows(own.row, theirs.row);
      const auto n = static_cast<Eigen::Index>(common.left.size());
      if (n < 100) continue;
      Eigen::VectorXd d(n);
      Eigen::MatrixXd e(n, 1);
      std::vector<int> row;
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        d[k] = own.values[common.left[at]];
        e(k, 0) = theirs.values[common.right[at]];
        row.push_back(own.row[static_cast<std::size_t>(common.left[at])]);
      }
      const Common place = CommonRows(without.row, row);
      if (place.left.size() != row.size()) continue;
      loss = std::min(loss, LossOfFit(Restrict(without, place.left), d, e, ar));
    }
    if (loss < kClassMargin) names.push_back(name);
  }
  return names;
}

}  // namespace sinew::rigs
