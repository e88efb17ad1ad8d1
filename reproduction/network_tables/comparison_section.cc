#include "reproduction/network_tables/comparison_text.h"

namespace sinew::reproduction {

using networks::Task;
using report::Text;

namespace {

// Test errors of every model, logarithmic.
report::Picture ErrorPicture(const ComparisonResult& result) {
  const bool published = !result.order_fair.empty();
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
  return picture;
}

}  // namespace

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

  section.pictures.push_back(ErrorPicture(result));
  return section;
}

}  // namespace sinew::reproduction
