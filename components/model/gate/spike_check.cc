#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"

namespace sinew::gate {

namespace {

using types::Run;
using types::Signal;

// Not the speeds: an impact turns them within a row, and they are not what is differentiated.
constexpr Signal kWatched[] = {Signal::kPosition,        Signal::kMotorPosition,
                               Signal::kMotorCurrent,    Signal::kTorque,
                               Signal::kChamberPressure, Signal::kReservoirPressure,
                               Signal::kLoadForce,       Signal::kTemperature};
constexpr Eigen::Index kSide = 4;  // rows on either side

struct Distance {
  // Of the row from its neighbours' parabola, and at most from the two next to it.
  double own = 0.0;
  double neighbours = 0.0;  // the largest of theirs
};

Distance FromParabola(const Run& run, const Eigen::VectorXd& x, Eigen::Index row) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double scale = run.time_s[row + kSide] - run.time_s[row - kSide];
  const auto powers = [&](Eigen::Index i) {
    const double s = (run.time_s[i] - run.time_s[row]) / scale;
    return Eigen::Vector3d(1.0, s, s * s);
  };
  for (Eigen::Index i = row - kSide; i <= row + kSide; ++i) {
    if (i == row) continue;
    const Eigen::Vector3d p = powers(i);
    gram.noalias() += p * p.transpose();
    right += (x[i] - x[row - 1]) * p;
  }
  const Eigen::Vector3d fit = gram.inverse() * right;
  Distance out;
  for (Eigen::Index i = row - kSide; i <= row + kSide; ++i) {
    const double distance = std::abs(x[i] - x[row - 1] - fit.dot(powers(i)));
    if (i == row) {
      // A wrong stamp moves a row along its curve: it stays between its neighbours.
      const double low = std::min(x[row - 1], x[row + 1]), high = std::max(x[row - 1], x[row + 1]);
      out.own = std::min(distance, std::max({0.0, low - x[row], x[row] - high}));
    } else {
      out.neighbours = std::max(out.neighbours, distance);
    }
  }
  return out;
}

// The step of a converter also where the channel rests: the low end of all changes, their middle
// where most rows repeat the one before.
double SmallSteps(const Eigen::VectorXd& x) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    if (x[i] != x[i - 1]) steps.push_back(std::abs(x[i] - x[i - 1]));
  }
  const bool rests = 2 * static_cast<Eigen::Index>(steps.size()) < x.size();
  return QuantileOf(std::move(steps), rests ? 0.5 : 0.05);
}

}  // namespace

std::vector<Measurement> CheckSpikes(const Run& run) {
  std::vector<Measurement> out;
  if (run.held || run.size() < 100) return out;
  for (const Signal signal : kWatched) {
    if (!run.Has(signal)) continue;
    const Eigen::VectorXd& x = run.At(signal);
    if (!(Range(x) > 0.0)) continue;
    std::vector<Distance> all;
    std::vector<double> own;
    for (Eigen::Index i = kSide; i + kSide < x.size(); ++i) {
      all.push_back(FromParabola(run, x, i));
      own.push_back(all.back().own);
    }
    const double usual = std::max({QuantileOf(own, 0.99), SmallestStep(x), SmallSteps(x)});
    double most = 0.0;
    std::size_t where = 0, count = 0;
    const auto statistic = [&](const Distance& at) {
      const double scale = std::max(usual, at.neighbours);
      return scale > 0.0 ? at.own / scale : 0.0;
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double s = statistic(all[i]);
      if (s > FindRule("spike").limit) ++count;
      if (s > most) {
        most = s;
        where = i;
      }
    }
    const Eigen::Index row = static_cast<Eigen::Index>(where) + kSide;
    Measurement at = Measure("spike", signal, run, {row, row}, most);
    at.reason = "the value " + Number(x[row]) + " " +
                std::string(types::SignalUnit(signal, run.kind)) + " stands alone between " +
                Number(x[row - 1]) + " and " + Number(x[row + 1]) +
                (count > 1 ? ", and " + std::to_string(count - 1) + " more like it." : ".");
    at.remedy = "Leave the rows out of the file (a missing row is no fault).";
    out.push_back(std::move(at));
  }
  return out;
}

}  // namespace sinew::gate
