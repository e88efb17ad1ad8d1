#include "reproduction/legs_table/legs_table.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "reproduction/network_tables/comparison_models.h"
#include "reproduction/networks/model.h"
#include "tools/jobs/jobs.h"

namespace sinew::reproduction {
namespace {

using networks::Method;
using networks::PublishedModel;
using report::Text;

// No training that is scored has the seed of those that choose hyper-parameters.
constexpr std::uint64_t kSearchSeed = 1000;
constexpr double kEsnGoal = 0.86;  // test MSE of the ESN over the FFNN's: published 0.0157 / 0.0183

LegsScores EmptyScores(int seeds) {
  const auto size = static_cast<std::size_t>(seeds);
  return {std::vector<double>(size), std::vector<double>(size), std::vector<double>(size)};
}

void Fill(const PublishedModel& plan, const networks::Samples& samples, std::uint64_t seed,
          std::size_t at, LegsScores* scores) {
  const auto start = std::chrono::steady_clock::now();
  const networks::FitResult fit = networks::Fit(plan, samples, {}, seed);
  scores->seconds[at] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  scores->train_mse[at] = fit.train_mse;
  scores->test_mse[at] = fit.test_mse;
}

ComparisonOptions FairOptions(const LegsTableOptions& options) {
  ComparisonOptions fair;
  fair.fair_epochs = options.epochs;
  fair.patience = options.patience;
  return fair;
}

std::string MeanAndDeviation(const std::vector<double>& values) {
  return Text("%.5f +- %.5f", identify::Mean(values), identify::StandardDeviation(values));
}

const LegsModel& FindLegsModel(const std::vector<LegsModel>& models, const char* name) {
  for (const LegsModel& model : models) {
    if (model.joints == 12 && model.plan.name == name) return model;
  }
  throw std::invalid_argument(std::string("table 6.5: no ") + name + " of 12 joints");
}

report::Comparison EsnOverFfnn(const std::vector<LegsModel>& models, const char* how,
                               LegsScores LegsModel::*scores) {
  const double ratio = identify::Mean((FindLegsModel(models, "ESN").*scores).test_mse) /
                       identify::Mean((FindLegsModel(models, "FFNN").*scores).test_mse);
  report::Comparison comparison;
  comparison.name = std::string("test MSE, ESN / FFNN, ") + how;
  comparison.published = "0.86";
  comparison.source = "table 6.5";
  comparison.ours = Text("%.3f", ratio);
  comparison.target = Text("at most %.2f", kEsnGoal);
  comparison.met = ratio <= kEsnGoal;
  return comparison;
}

}  // namespace

std::vector<LegsModel> FillLegsTable(
    const std::vector<LegsData>& data, const LegsTableOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  if (options.seeds < 2 || options.trials < 1 || options.epochs < 1 || options.patience < 1) {
    throw std::invalid_argument(
        "table 6.5: expected at least 2 seeds, 1 trial, 1 epoch, patience 1");
  }
  std::vector<LegsModel> models;
  for (const LegsData& set : data) {
    for (PublishedModel& plan : networks::Table65(set.joints)) {
      LegsModel model;
      model.parameters = networks::CountParameters(plan);
      model.plan = std::move(plan);
      model.joints = set.joints;
      model.published = EmptyScores(options.seeds);
      model.fair = EmptyScores(options.seeds);
      models.push_back(std::move(model));
    }
  }
  const auto data_of = [&data](const LegsModel& model) -> const LegsData& {
    return *std::find_if(data.begin(), data.end(),
                         [&](const LegsData& set) { return set.joints == model.joints; });
  };
  const ComparisonOptions fair = FairOptions(options);
  const auto trials = static_cast<std::size_t>(options.trials);
  const auto seeds = static_cast<std::size_t>(options.seeds);
  const std::size_t total = models.size() * (trials + 2 * seeds);
  std::size_t before = 0;
  const auto run = [&](const std::vector<std::function<void()>>& jobs) {
    tools::RunJobs(jobs, options.threads, [&](std::size_t done) {
      if (progress) progress(before + done, total);
    });
    before += jobs.size();
  };

  std::vector<std::vector<double>> validation(models.size(), std::vector<double>(trials));
  const auto draw = [&](std::size_t m, std::size_t trial) {
    return DrawHyperParameters(models[m].plan, static_cast<int>(trial), options.seed + m, fair);
  };
  std::vector<std::function<void()>> jobs;
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (std::size_t k = 0; k < trials; ++k) {
      jobs.push_back([&, m, k] {
        const double error =
            networks::Fit(draw(m, k), data_of(models[m]).fair, {}, options.seed + kSearchSeed)
                .validation_mse;
        validation[m][k] = std::isfinite(error) ? error : std::numeric_limits<double>::max();
      });
    }
  }
  run(jobs);

  jobs.clear();
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto best = std::min_element(validation[m].begin(), validation[m].end());
    const PublishedModel plan = draw(m, static_cast<std::size_t>(best - validation[m].begin()));
    models[m].chosen = HyperText(plan);
    for (std::size_t s = 0; s < seeds; ++s) {
      jobs.push_back([&, m, s] {
        LegsModel& model = models[m];
        Fill(model.plan, data_of(model).all, options.seed + s, s, &model.published);
      });
      jobs.push_back([&, m, s, plan] {
        LegsModel& model = models[m];
        Fill(plan, data_of(model).fair, options.seed + s, s, &model.fair);
      });
    }
  }
  run(jobs);
  return models;
}

report::Section LegsSection(const std::vector<LegsModel>& models, const LegsTableOptions& options,
                            const std::string& data_text) {
  report::Section section;
  section.id = "table-6-5";
  section.title = "Networks for the inverse dynamics of the biped (table 6.5)";
  section.paragraphs = {
      data_text,
      "Every MSE is of targets normalised by mean and standard deviation of the training samples, "
      "the mean over the outputs. In an upright squat hip yaw, hip roll and ankle roll stand still "
      "here, without noise: their torque is constant, and half of the twelve outputs have no "
      "error. "
      "The source does not give the unit of its values.",
      "The source gives neither epochs nor batch for this table: once 10 epochs of batch 32, as "
      "for "
      "table 6.4, once until the validation error stops falling."};
  section.comparisons.push_back(EsnOverFfnn(models, "10 epochs", &LegsModel::published));
  section.comparisons.push_back(EsnOverFfnn(models, "fair", &LegsModel::fair));
  report::Table table;
  table.title = "Table 6.5";
  table.caption = Text("Mean and standard deviation over %d seeds, one recording.", options.seeds);
  table.header = {"model",           "inputs / outputs", "parameters", "test MSE published",
                  "ours, 10 epochs", "training s",       "ours, fair", "training s",
                  "chosen"};
  for (const LegsModel& model : models) {
    const bool counted = model.joints == 12;
    table.rows.push_back(
        {model.plan.name, Text("%d / %d", 3 * model.joints, model.joints),
         counted ? Text("%d (%d)", model.parameters, model.plan.published_parameters)
                 : std::to_string(model.parameters),
         counted ? Text("%.4f +- %.4f", model.plan.test_mse, model.plan.test_sd) : "",
         MeanAndDeviation(model.published.test_mse),
         Text("%.2f", identify::Mean(model.published.seconds)),
         MeanAndDeviation(model.fair.test_mse), Text("%.2f", identify::Mean(model.fair.seconds)),
         model.chosen});
    if (counted && !model.plan.remark.empty()) {
      section.paragraphs.push_back(model.plan.name + ": " + model.plan.remark + ".");
    }
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace sinew::reproduction
