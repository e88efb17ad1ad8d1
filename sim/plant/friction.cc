#include "sim/plant/friction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sinew::plant {

namespace {

constexpr int kMostRounds = 100;
constexpr double kConverged = 1e-14;  // change of a velocity
// Joints of which the sticking ones are solved together; a robot has fewer.
constexpr std::size_t kMostTogether = 32;

// A problem in friction.h's terms.
struct Impulses {
  std::span<const double> inverse_inertia, lower, upper;
  std::span<double> impulse, velocity;

  std::size_t size() const { return velocity.size(); }
  double inverse(std::size_t i, std::size_t k) const { return inverse_inertia[i * size() + k]; }
  bool Sticks(std::size_t i) const { return impulse[i] > lower[i] && impulse[i] < upper[i]; }
  void Change(std::size_t i, double change) const {
    for (std::size_t k = 0; k < size(); ++k) velocity[k] += inverse(k, i) * change;
  }
};

// At most that many rounds of projected Gauss-Seidel; true: converged.
bool Rounds(const Impulses& problem, int most) noexcept {
  for (int round = 0; round < most; ++round) {
    double largest = 0.0;
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const double wanted = problem.impulse[i] - problem.velocity[i] / problem.inverse(i, i);
      const double next = std::clamp(wanted, problem.lower[i], problem.upper[i]);
      const double change = next - problem.impulse[i];
      if (change == 0.0) continue;
      problem.impulse[i] = next;
      problem.Change(i, change);
      largest = std::max(largest, std::abs(problem.inverse(i, i) * change));
    }
    if (!(largest > kConverged)) return true;
  }
  return false;
}

// The impulses at which all joints that stick now stand still, by Cholesky's factor of their part
// of W; kept within the bounds. Nothing happens where that part is not positive definite.
void StickTogether(const Impulses& problem) noexcept {
  std::array<std::size_t, kMostTogether> at{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (problem.Sticks(i)) at[count++] = i;
  }
  std::array<std::array<double, kMostTogether>, kMostTogether> factor;
  std::array<double, kMostTogether> x;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      double rest = problem.inverse(at[i], at[k]);
      for (std::size_t m = 0; m < k; ++m) rest -= factor[i][m] * factor[k][m];
      if (k < i) {
        factor[i][k] = rest / factor[k][k];
      } else if (!(rest > 0.0)) {
        return;
      } else {
        factor[i][i] = std::sqrt(rest);
      }
    }
    double rest = -problem.velocity[at[i]];
    for (std::size_t m = 0; m < i; ++m) rest -= factor[i][m] * x[m];
    x[i] = rest / factor[i][i];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t m = i + 1; m < count; ++m) x[i] -= factor[m][i] * x[m];
    x[i] /= factor[i][i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t joint = at[i];
    const double next =
        std::clamp(problem.impulse[joint] + x[i], problem.lower[joint], problem.upper[joint]);
    const double change = next - problem.impulse[joint];
    problem.impulse[joint] = next;
    problem.Change(joint, change);
  }
}

void StandStill(const Impulses& problem) noexcept {
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (problem.Sticks(i)) problem.velocity[i] = 0.0;
  }
}

}  // namespace

void ApplyImpulses(std::span<const double> inverse_inertia, std::span<const double> lower,
                   std::span<const double> upper, std::span<double> impulse,
                   std::span<double> velocity) noexcept {
  const Impulses problem{inverse_inertia, lower, upper, impulse, velocity};
  std::fill(impulse.begin(), impulse.end(), 0.0);
  (void)Rounds(problem, problem.size() == 1 ? 1 : kMostRounds);
  StandStill(problem);
}

// Gauss-Seidel's rounds find which joints stick, and where many are coupled take long to bring them
// to rest: in between they are solved together (Silcowitz, Niebe, Erleben: Projected Gauss-Seidel
// subspace minimization method for interactive rigid body dynamics, GRAPP (2010) 38).
void ApplyImpulsesFrom(std::span<const double> inverse_inertia, std::span<const double> lower,
                       std::span<const double> upper, std::span<double> impulse,
                       std::span<double> velocity) noexcept {
  const Impulses problem{inverse_inertia, lower, upper, impulse, velocity};
  for (std::size_t i = 0; i < problem.size(); ++i) {
    impulse[i] = std::clamp(impulse[i], lower[i], upper[i]);
    if (impulse[i] != 0.0) problem.Change(i, impulse[i]);
  }
  constexpr int kRoundsBetween = 2;
  for (int round = 0; round < kMostRounds; round += kRoundsBetween) {
    if (Rounds(problem, kRoundsBetween)) break;
    if (problem.size() <= kMostTogether) StickTogether(problem);
  }
  StandStill(problem);
}

}  // namespace sinew::plant
