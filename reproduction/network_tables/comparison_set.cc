#include "reproduction/network_tables/comparison_set.h"

#include <cmath>

#include "components/model/identify/statistics.h"
#include "reproduction/training_sets/training_sets.h"

namespace sinew::reproduction {

using networks::Samples;
using networks::Task;

namespace {

// A recording of the cylinder is about ten cycles: ten blocks would keep the same part of every
// cycle for testing. Two blocks have four cycles each for training, and a quarter of that is a
// whole cycle.
constexpr int kCylinderBlocks = 2;
constexpr double kCylinderValidationShare = 0.25;

}  // namespace

ComparisonSet MakeComparisonSet(const std::vector<types::Run>& runs, Task task, double period_s) {
  const bool cylinder = task == Task::kForce;
  const std::vector<esn::Sequence> sequences = networks::MakeTable(
      runs, {.task = task, .period_s = period_s, .blocks = cylinder ? kCylinderBlocks : 10});
  ComparisonSet set;
  set.published = networks::MakeSamples(sequences);
  set.fair = networks::MakeSamples(
      sequences, cylinder ? kCylinderValidationShare : kValidationShare, cylinder ? 1 : kGap);
  set.deviation = set.published.output.scale(0);
  set.duration_s = set.published.count() * period_s;
  const Samples& s = set.published;
  set.quiet = Eigen::VectorXd::Zero(s.count());
  std::vector<double> play;
  if (task == Task::kSea) play.assign(s.inputs.row(0).begin(), s.inputs.row(0).end());
  const double low = play.empty() ? 0.0 : identify::Quantile(play, 0.02);
  const double high = play.empty() ? 0.0 : identify::Quantile(play, 0.98);
  for (int t = 0; t < s.count(); ++t) {
    if (task == Task::kSea) {
      // Within a twentieth of the travel of either end.
      const double place = (s.inputs(0, t) - low) / (high - low);
      set.quiet(t) = place < 0.05 || place > 0.95 ? 1.0 : 0.0;
    } else {
      const double speed = std::abs(s.inputs(1, t) * s.input.scale(1) + s.input.offset(1));
      set.quiet(t) = speed < (task == Task::kPea ? 0.3 : 1e-3) ? 1.0 : 0.0;
    }
  }
  return set;
}

void AddParts(const ComparisonSet& set, const Eigen::MatrixXd& predicted, const Samples& samples,
              double* quiet, double* busy) {
  const double count = static_cast<double>(samples.test.size());
  for (const int t : samples.test) {
    const double error = (predicted.col(t) - samples.targets.col(t)).squaredNorm() / count;
    (set.quiet(t) > 0.0 ? *quiet : *busy) += error;
  }
}

}  // namespace sinew::reproduction
