#include <algorithm>

#include "reproduction/network_tables/comparison_text.h"

namespace sinew::reproduction {
namespace {

using networks::Method;
using networks::Task;
using report::Text;

std::string Order(const std::vector<const ComparedModel*>& models) {
  std::string text;
  for (const ComparedModel* model : models) text += (text.empty() ? "" : " < ") + model->plan.name;
  return text;
}

template <typename Value>
std::vector<const ComparedModel*> Sorted(const ComparisonResult& result, Value value) {
  std::vector<const ComparedModel*> models;
  for (const ComparedModel& model : result.models) {
    if (!model.extra) models.push_back(&model);
  }
  std::stable_sort(models.begin(), models.end(),
                   [&](const auto* a, const auto* b) { return value(*a) < value(*b); });
  return models;
}

// What the runs show of a difference in order, each from figures of this very comparison.
std::vector<std::string> Reasons(const ComparisonResult& result) {
  std::vector<std::string> reasons;
  std::vector<const ComparedModel*> nets;
  for (const ComparedModel& model : result.models) {
    if (!model.extra && model.plan.method == Method::kNet && model.as_published) {
      nets.push_back(&model);
    }
  }
  // Too few updates: how much the same nets gain from a validation stop.
  std::string gains;
  for (const ComparedModel* model : nets) {
    const double from = TestMean(*model->as_published), to = TestMean(model->fair);
    if (from > 1.2 * to) {
      gains +=
          (gains.empty() ? "" : ", ") + Text("%s %.4f -> %.4f", model->plan.name.c_str(), from, to);
    }
  }
  if (!gains.empty()) {
    reasons.push_back(
        "Unfinished training: with the published epochs, batch and rate these networks had not "
        "converged; trained until the validation error stops falling they reach (test MSE): " +
        gains + ".");
  }
  if (!result.curve.empty()) {
    std::string curve;
    for (const CurvePoint& point : result.curve) {
      curve += (curve.empty() ? "" : "; ") + Text("%ld samples: %.4f and %.4f (%s)",
                                                  point.train_samples, point.best_mse,
                                                  point.second_mse, point.order.verdict.c_str());
    }
    reasons.push_back("Amount of data: test MSE of " + result.curve_best + " and " +
                      result.curve_second +
                      ", trained as published on more and more sets of one specimen: " + curve +
                      ". The published batch of 6600 was the whole training set.");
  }
  for (const ComparedModel& model : result.models) {
    if (model.plan.name != "ESN (GCV)") continue;
    for (const ComparedModel& twin : result.models) {
      if (twin.plan.name != "ESN" || TestMean(model.fair) < 1.5 * TestMean(twin.fair)) continue;
      reasons.push_back(Text(
          "Ridge strength: with the strength by generalised cross-validation the same reservoirs "
          "have a test MSE of %.4f instead of %.4f by the validation error; cross-validation takes "
          "neighbouring samples for independent ones and regularises too little.",
          TestMean(model.fair), TestMean(twin.fair)));
    }
  }
  if (result.options.task == Task::kPea) {
    std::string pairs;
    for (const char* kind : {"ESN", "LSTM"}) {
      const ComparedModel* pure = nullptr;
      const ComparedModel* wiener = nullptr;
      for (const ComparedModel& model : result.models) {
        if (model.plan.name == std::string("Pure ") + kind) pure = &model;
        if (model.plan.name == std::string("Wiener ") + kind) wiener = &model;
      }
      if (pure == nullptr || wiener == nullptr) continue;
      const PairedOrder order =
          ComparePaired(pure->published_pairs->test_mse, wiener->published_pairs->test_mse);
      pairs += (pairs.empty() ? "" : ", ") +
               Text("%s %+.5f (%+.5f .. %+.5f)", kind, order.mean, order.low, order.high);
    }
    reasons.push_back(
        "The Wiener form: with three coefficients (N = 0 in (4.45)) the linear block's output is a "
        "sum of inputs that the network has anyway, so it brings no information. Wiener - pure, "
        "test MSE as published, paired: " +
        pairs + ".");
  }
  std::string parts;
  for (const ComparedModel& model : result.models) {
    const double sum = model.quiet_mse + model.busy_mse;
    if (!(sum > 0.0)) continue;
    parts += (parts.empty() ? "" : ", ") +
             Text("%s %.0f %%", model.plan.name.c_str(), 100.0 * model.quiet_mse / sum);
  }
  reasons.push_back(Text("Where the fair error is: %s, which is %.0f %% of the test samples, holds "
                         "this share of it: ",
                         result.quiet.c_str(), 100.0 * result.quiet_share) +
                    parts + ".");
  return reasons;
}

}  // namespace

std::vector<std::string> ComparisonParagraphs(const ComparisonResult& result) {
  const Task task = result.options.task;
  const networks::TaskInfo& info = networks::InfoOf(task);
  std::vector<std::string> paragraphs;
  std::string inputs;
  for (const std::string_view name : info.inputs) {
    inputs += (inputs.empty() ? "" : ", ") + std::string(name);
  }
  std::string data =
      result.options.runs.empty()
          ? Text(
                "Data: the surrogate's %s set, %.0f s, %ld training and %ld test samples at %.0f "
                "Hz (the first set; every further one is of another specimen). ",
                std::string(info.name).c_str(), result.duration_s, result.train_samples,
                result.test_samples, 1.0 / result.options.period_s)
          : Text("Data: %zu recordings, %.0f s, %ld training and %ld test samples at %.0f Hz. ",
                 result.options.runs.size(), result.duration_s, result.train_samples,
                 result.test_samples, 1.0 / result.options.period_s);
  data += "Inputs: " + inputs + "; target: " + std::string(info.target) + ". ";
  if (task == Task::kSea) {
    data += "The angle is that of the play; gravity is neither input nor target. ";
  }
  if (task == Task::kPea) {
    data +=
        "The target is computed from the motor current, so neither it nor a multiple of it is an "
        "input. "
        "The linear block reads acceleration, velocity and load force. ";
  }
  data +=
      "Split: ten consecutive blocks, the first 70 % of each for training, the rest for testing.";
  paragraphs.push_back(data);
  paragraphs.push_back(
      Text("Every MSE is of the target normalised by mean and standard deviation of the training "
           "samples (%.4g %s): a share of its variance. The source does not say its unit, so "
           "published values are beside ours for order and ratio, not for size.",
           result.target_deviation, std::string(info.unit).c_str()));
  if (task == Task::kPea && result.constant_torque_noise_share > 0.0) {
    paragraphs.push_back(Text(
        "The motor's torque level changes every second or so in these sets. With one constant set "
        "point in torque mode, as the experiment can also be read, %.0f %% of the target's "
        "variance would be noise of the current sensor, and there would be nothing to learn.",
        std::min(100.0, 100.0 * result.constant_torque_noise_share)));
  }
  if (!result.order_fair.empty()) {
    const auto published = Sorted(result, [](const ComparedModel& m) { return m.plan.test_mse; });
    const auto ours =
        Sorted(result, [](const ComparedModel& m) { return TestMean(*m.as_published); });
    const auto fair = Sorted(result, [](const ComparedModel& m) { return TestMean(m.fair); });
    paragraphs.push_back("Published order: " + Order(published) + ".");
    paragraphs.push_back("Ours, trained as published: " + Order(ours) + ".");
    paragraphs.push_back("Ours, trained fairly: " + Order(fair) + ".");
    int reversed = 0, same = 0;
    for (const PairedOrder& o : result.order_published) {
      if (o.verdict == "reversed") ++reversed;
      if (o.verdict == "as published") ++same;
    }
    paragraphs.push_back(
        Text("Of %zu neighbours in the published order %d are so here too, %d are reversed and %zu "
             "are not distinguished (paired 95 %% intervals over %d seeds, each with a data set of "
             "its own, trained as published).",
             result.order_published.size(), same, reversed,
             result.order_published.size() - static_cast<std::size_t>(same + reversed),
             result.options.seeds));
  }
  for (const std::string& reason : Reasons(result)) paragraphs.push_back(reason);
  return paragraphs;
}

}  // namespace sinew::reproduction
