#include "reproduction/networks/comparison_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sinew::reproduction {
namespace {

using networks::Method;
using networks::Task;
using report::Text;

double TestMean(const Runs& runs) { return runs.Mean(runs.test_mse); }
double TestDeviation(const Runs& runs) { return runs.Deviation(runs.test_mse); }

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

const char* TableName(Task task) {
  return task == Task::kSea ? "table 6.2" : task == Task::kPea ? "table 6.4" : "cylinder";
}

void AppendOrders(const std::vector<PairedOrder>& orders, std::string* text) {
  for (const PairedOrder& o : orders) {
    *text += Text("  %-15s - %-15s published %+.4f   ours %+.5f (%+.5f .. %+.5f)   %s\n",
                  o.worse.c_str(), o.better.c_str(), o.published_difference, o.mean, o.low, o.high,
                  o.verdict.c_str());
  }
}

nlohmann::ordered_json RunsJson(const Runs& runs) {
  return {{"train_mse_mean", runs.Mean(runs.train_mse)},
          {"train_mse_sd", runs.Deviation(runs.train_mse)},
          {"test_mse_mean", TestMean(runs)},
          {"test_mse_sd", TestDeviation(runs)},
          {"test_mse", runs.test_mse},
          {"train_time_s", runs.Mean(runs.seconds)},
          {"epochs", runs.epochs}};
}

nlohmann::ordered_json OrdersJson(const std::vector<PairedOrder>& orders) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PairedOrder& o : orders) {
    list.push_back({{"better_published", o.better},
                    {"worse_published", o.worse},
                    {"published_difference", o.published_difference},
                    {"difference", o.mean},
                    {"low_95", o.low},
                    {"high_95", o.high},
                    {"pairs", o.pairs},
                    {"verdict", o.verdict}});
  }
  return list;
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
        "The target is told by the motor current, so neither it nor a multiple of it is an input. "
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
             "are not told apart (paired 95 %% intervals over %d seeds, each with a data set of "
             "its own, trained as published).",
             result.order_published.size(), same, reversed,
             result.order_published.size() - static_cast<std::size_t>(same + reversed),
             result.options.seeds));
  }
  for (const std::string& reason : Reasons(result)) paragraphs.push_back(reason);
  return paragraphs;
}

std::string FormatComparison(const ComparisonResult& result) {
  std::string text;
  const bool published = !result.order_fair.empty();
  if (published) {
    text +=
        Text("%s as published: same sizes, epochs, batches and rate; %d seeds on one data set\n",
             TableName(result.options.task), result.options.seeds);
    text +=
        "model              parameters      test MSE published      test MSE ours           "
        "train ours   time s   step us\n";
    for (const ComparedModel& m : result.models) {
      if (!m.as_published) continue;
      const Runs& runs = *m.as_published;
      text += Text("%-18s %4d", m.plan.name.c_str(), m.parameters);
      text += m.extra ? "                                    "
                      : Text(" (%4d)    %.4f +- %.4f     ", m.plan.published_parameters,
                             m.plan.test_mse, m.plan.test_sd);
      text += Text("    %.5f +- %.5f     %.5f   %7.3f", TestMean(runs), TestDeviation(runs),
                   runs.Mean(runs.train_mse), runs.Mean(runs.seconds));
      text += m.extra ? "         -\n" : Text("   %7.3f\n", m.step_us);
    }
    text += Text("%-18s %41s %.5f\n", "noise floor", "", result.noise_floor);
    text += "order, paired by seed and data set (worse - better as published, 95 %):\n";
    AppendOrders(result.order_published, &text);
    text += '\n';
  }
  text += Text("fair: %d trials of hyper-parameters each, validation stop, a data set %s\n",
               result.options.trials, published ? "for every seed" : "for all seeds");
  text +=
      "model              parameters  test MSE               train      time s   step us  chosen\n";
  for (const ComparedModel& m : result.models) {
    text += Text("%-18s %4d        %.5f +- %.5f    %.5f   %7.3f", m.plan.name.c_str(), m.parameters,
                 TestMean(m.fair), TestDeviation(m.fair), m.fair.Mean(m.fair.train_mse),
                 m.fair.Mean(m.fair.seconds));
    text += (m.extra ? std::string("         -") : Text("   %7.3f", m.step_us)) + "  " +
            m.fair_hyper + "\n";
  }
  text += Text("%-18s             %.5f\n", "noise floor", result.noise_floor);
  if (published) {
    text += "order, paired (worse - better as published, 95 %):\n";
    AppendOrders(result.order_fair, &text);
  }
  text += '\n';
  for (const std::string& paragraph : ComparisonParagraphs(result)) text += paragraph + "\n";
  for (const ComparedModel& m : result.models) {
    if (!m.plan.remark.empty()) text += m.plan.name + ": " + m.plan.remark + ".\n";
  }
  text += Text("%.0f s\n", result.seconds);
  return text;
}

report::Section ComparisonSection(const ComparisonResult& result) {
  const bool published = !result.order_fair.empty();
  const Task task = result.options.task;
  report::Section section;
  section.id = task == Task::kSea ? "table-6-2" : task == Task::kPea ? "table-6-4" : "cylinder";
  section.title = task == Task::kSea   ? "Networks inside the backlash (table 6.2)"
                  : task == Task::kPea ? "Networks outside the backlash (table 6.4)"
                                       : "Networks on a measured pneumatic cylinder";
  section.paragraphs = ComparisonParagraphs(result);
  for (const ComparedModel& m : result.models) {
    if (!m.plan.remark.empty()) {
      section.paragraphs.push_back(m.plan.name + ": " + m.plan.remark + ".");
    }
  }
  section.seconds = result.seconds;
  const auto pm = [](double mean, double deviation) {
    return Text("%.5f +- %.5f", mean, deviation);
  };
  if (published) {
    for (const ComparedModel& m : result.models) {
      if (m.extra) continue;
      report::Comparison count;
      count.name = m.plan.name + ", parameters";
      count.published = std::to_string(m.plan.published_parameters);
      count.source = task == Task::kSea ? "(6.1)-(6.5)" : "(6.6)-(6.12)";
      count.ours = std::to_string(m.parameters);
      count.target = "equal";
      count.met = m.parameters == m.plan.published_parameters;
      section.comparisons.push_back(count);
    }
    for (const PairedOrder& o : result.order_published) {
      report::Comparison order;
      order.name = "test MSE, " + o.worse + " - " + o.better;
      order.published = Text("%+.4f", o.published_difference);
      order.source = TableName(task);
      order.ours = Text("%+.5f", o.mean);
      order.interval = Text("%+.5f .. %+.5f", o.low, o.high);
      order.remark = o.verdict;
      section.comparisons.push_back(order);
    }
    report::Table table;
    table.title = std::string(TableName(task)) + ", trained as published";
    table.caption =
        Text("Mean and standard deviation over %d seeds on one data set.", result.options.seeds);
    table.header = {"model",      "parameters", "test MSE published", "test MSE ours", "train ours",
                    "training s", "step us"};
    for (const ComparedModel& m : result.models) {
      if (!m.as_published) continue;
      const Runs& runs = *m.as_published;
      table.rows.push_back(
          {m.plan.name, std::to_string(m.parameters),
           m.extra ? "" : Text("%.4f +- %.4f", m.plan.test_mse, m.plan.test_sd),
           pm(TestMean(runs), TestDeviation(runs)), Text("%.5f", runs.Mean(runs.train_mse)),
           Text("%.3f", runs.Mean(runs.seconds)), m.extra ? "" : Text("%.3f", m.step_us)});
    }
    table.rows.push_back({"noise floor", "", "", Text("%.5f", result.noise_floor), "", "", ""});
    section.tables.push_back(table);
  }
  report::Table fair;
  fair.title = "Trained fairly";
  fair.caption = Text("%d trials of hyper-parameters for each model, validation stop, %d seeds%s.",
                      result.options.trials, result.options.seeds,
                      published ? ", each on a data set of its own" : "");
  fair.header = {"model", "parameters", "test MSE", "train", "training s", "step us", "chosen"};
  for (const ComparedModel& m : result.models) {
    fair.rows.push_back(
        {m.plan.name, std::to_string(m.parameters), pm(TestMean(m.fair), TestDeviation(m.fair)),
         Text("%.5f", m.fair.Mean(m.fair.train_mse)), Text("%.3f", m.fair.Mean(m.fair.seconds)),
         m.extra ? "" : Text("%.3f", m.step_us), m.fair_hyper});
  }
  fair.rows.push_back({"noise floor", "", Text("%.5f", result.noise_floor), "", "", "", ""});
  section.tables.push_back(fair);
  if (published) {
    report::Table order;
    order.title = "Order of the published table, trained fairly";
    order.caption = "Differences of test MSE, paired by seed and data set.";
    order.header = {"worse - better as published", "published", "ours", "95 %", "verdict"};
    for (const PairedOrder& o : result.order_fair) {
      order.rows.push_back({o.worse + " - " + o.better, Text("%+.4f", o.published_difference),
                            Text("%+.5f", o.mean), Text("%+.5f .. %+.5f", o.low, o.high),
                            o.verdict});
    }
    section.tables.push_back(order);
  }

  report::Picture picture;
  picture.title = published ? "Test MSE, published and ours" : "Test MSE";
  picture.caption = "Normalised, logarithmic; the bars are standard deviations over the seeds.";
  std::string data = "$d << EOD\n";
  std::string names;
  int row = 0;
  for (const ComparedModel& m : result.models) {
    const auto value = [](double x) { return report::PictureNumber(x); };
    const Runs& first = m.as_published ? *m.as_published : m.fair;
    names += (row > 0 ? ", '" : "'") + m.plan.name + "' " + std::to_string(row);
    data += std::to_string(row++) + " \"" + m.plan.name + "\" " +
            (m.plan.test_mse > 0.0 && !m.extra && published ? value(m.plan.test_mse) : "NaN") +
            " " + (m.as_published ? value(TestMean(first)) : "NaN") + " " +
            value(TestDeviation(first)) + " " + value(TestMean(m.fair)) + " " +
            value(TestDeviation(m.fair)) + "\n";
  }
  data += "EOD\n";
  picture.script =
      report::PictureHead(360) + data +
      "set logscale y\nset ylabel 'test MSE'\nset xrange [-0.6:" + std::to_string(row) +
      "-0.4]\nset xtics rotate by -20 (" + names + ")\n" +
      "set bars small\nfloor = " + report::PictureNumber(result.noise_floor) + "\n" + "plot ";
  if (published) {
    picture.script += std::string(
                          "$d using ($1-0.2):3 with points pointtype 5 pointsize 1 "
                          "linecolor rgb '") +
                      report::kMeasuredColour +
                      "' title 'published', '' using 1:4:5 with yerrorbars pointtype 7 pointsize "
                      "0.9 linewidth 1.6 linecolor rgb '" +
                      report::kBeforeColour + "' title 'ours, as published', '' ";
  } else {
    picture.script += "$d ";
  }
  picture.script += std::string(
                        "using ($1+0.2):6:7 with yerrorbars pointtype 7 pointsize "
                        "0.9 linewidth 1.6 linecolor rgb '") +
                    report::kAfterColour +
                    "' title 'ours, fair', floor with lines linewidth 1.5 dashtype 2 linecolor rgb "
                    "'" +
                    report::kSeriesColours[0] + "' title 'noise floor'\n";
  section.pictures.push_back(picture);
  return section;
}

nlohmann::ordered_json ComparisonJson(const ComparisonResult& result) {
  nlohmann::ordered_json json = {{"task", std::string(networks::InfoOf(result.options.task).name)},
                                 {"seeds", result.options.seeds},
                                 {"trials", result.options.trials},
                                 {"train_samples", result.train_samples},
                                 {"test_samples", result.test_samples},
                                 {"normalised_by", result.target_deviation},
                                 {"unit", std::string(networks::InfoOf(result.options.task).unit)},
                                 {"noise_floor", result.noise_floor}};
  for (const ComparedModel& m : result.models) {
    nlohmann::ordered_json model = {{"name", m.plan.name}, {"parameters", m.parameters}};
    if (!m.extra && m.plan.test_mse > 0.0) {
      model["published"] = {{"parameters", m.plan.published_parameters},
                            {"train_mse", m.plan.train_mse},
                            {"test_mse", m.plan.test_mse},
                            {"train_sd", m.plan.train_sd},
                            {"test_sd", m.plan.test_sd}};
    }
    if (m.as_published) model["as_published"] = RunsJson(*m.as_published);
    if (m.published_pairs) model["as_published_pairs"] = RunsJson(*m.published_pairs);
    model["fair"] = RunsJson(m.fair);
    model["fair"]["chosen"] = m.fair_hyper;
    model["fair"]["quiet_mse"] = m.quiet_mse;
    model["fair"]["busy_mse"] = m.busy_mse;
    if (!m.extra) model["step_us"] = m.step_us;
    if (!m.plan.remark.empty()) model["remark"] = m.plan.remark;
    json["models"].push_back(std::move(model));
  }
  for (const CurvePoint& point : result.curve) {
    json["learning_curve"].push_back({{"sets", point.sets},
                                      {"train_samples", point.train_samples},
                                      {result.curve_best, point.best_mse},
                                      {result.curve_second, point.second_mse},
                                      {"low_95", point.order.low},
                                      {"high_95", point.order.high},
                                      {"verdict", point.order.verdict}});
  }
  json["order_as_published"] = OrdersJson(result.order_published);
  json["order_fair"] = OrdersJson(result.order_fair);
  json["notes"] = ComparisonParagraphs(result);
  json["time_s"] = result.seconds;
  return json;
}

}  // namespace sinew::reproduction
