#include "reproduction/network_tables/comparison_text.h"

#include <nlohmann/json.hpp>

namespace sinew::reproduction {

using report::Text;

namespace {

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

}  // namespace

const char* TableName(networks::Task task) {
  return task == networks::Task::kSea   ? "table 6.2"
         : task == networks::Task::kPea ? "table 6.4"
                                        : "cylinder";
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
