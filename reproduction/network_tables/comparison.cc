#include "reproduction/network_tables/comparison.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "reproduction/network_tables/comparison_models.h"
#include "reproduction/network_tables/comparison_set.h"
#include "reproduction/networks/grey_box.h"
#include "reproduction/training_sets/training_sets.h"
#include "tools/jobs/jobs.h"

namespace sinew::reproduction {
namespace {

using networks::Kind;
using networks::Method;
using networks::PublishedModel;
using networks::Samples;
using networks::Task;
using SteadyClock = std::chrono::steady_clock;

// The data set on which hyper-parameters are chosen is none of those that are scored.
constexpr std::uint64_t kSearchSet = 1000;

void Keep(Runs* runs, int at, const TimedFit& timed) {
  const std::size_t k = static_cast<std::size_t>(at);
  runs->train_mse[k] = timed.fit.train_mse;
  runs->test_mse[k] = timed.fit.test_mse;
  runs->seconds[k] = timed.seconds;
  runs->epochs[k] = timed.fit.training.epochs;
}

Runs Empty(int count) {
  const std::size_t size = static_cast<std::size_t>(count);
  return {std::vector<double>(size), std::vector<double>(size), std::vector<double>(size),
          std::vector<int>(size)};
}

std::vector<PairedOrder> Orders(const std::vector<ComparedModel>& models, bool fair) {
  std::vector<const ComparedModel*> sorted;
  for (const ComparedModel& model : models) {
    if (!model.extra && model.plan.test_mse > 0.0) sorted.push_back(&model);
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const auto* a, const auto* b) { return a->plan.test_mse < b->plan.test_mse; });
  std::vector<PairedOrder> orders;
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    const ComparedModel& better = *sorted[k - 1];
    const ComparedModel& worse = *sorted[k];
    PairedOrder order =
        fair ? ComparePaired(better.fair.test_mse, worse.fair.test_mse)
             : ComparePaired(better.published_pairs->test_mse, worse.published_pairs->test_mse);
    order.better = better.plan.name;
    order.worse = worse.plan.name;
    order.published_difference = worse.plan.test_mse - better.plan.test_mse;
    orders.push_back(order);
  }
  return orders;
}

ComparisonOptions Completed(ComparisonOptions options) {
  if (options.fair_epochs == 0) {
    options.fair_epochs = options.task == Task::kSea   ? 1500
                          : options.task == Task::kPea ? 200
                                                       : 400;
  }
  if (options.seeds < 2 || options.trials < 1 || options.fair_epochs < 1 || options.patience < 1) {
    throw std::invalid_argument(
        "comparison: expected at least 2 seeds, 1 trial, 1 epoch, patience 1");
  }
  return options;
}

// One comparison. Run is called once; its steps fill what the later ones read.
class Comparer {
 public:
  Comparer(const ComparisonOptions& options, const Progress& progress);
  ComparisonResult Run();

 private:
  void RunCounted(const std::vector<std::function<void()>>& jobs);
  const ComparisonSet& SetOf(int seed) const {
    return sets_[surrogate_ ? static_cast<std::size_t>(seed) : 0];
  }
  void MakeSets();
  void TrainAsPublished();
  void SearchHyperParameters();
  void AddGcvTwins();
  void TrainFairly();
  void MeasureLearningCurve();
  void AddGreyBox();
  void DescribeData();

  const ComparisonOptions options_;
  const Progress progress_;
  const SteadyClock::time_point start_ = SteadyClock::now();
  const networks::Task task_;
  const bool surrogate_;
  const bool as_published_;
  const int seeds_;
  ComparisonResult result_;
  std::size_t models_ = 0;  // of the published table
  std::size_t set_jobs_ = 0;
  std::size_t before_ = 0, total_ = 0;  // jobs
  std::vector<int> curve_sizes_;
  std::vector<ComparisonSet> sets_;              // the last one is for the search
  std::vector<std::size_t> dear_;                // models, the longest trainings first
  std::vector<networks::Model> first_;           // for the time of a step
  std::vector<std::vector<double>> validation_;  // model x trial
  std::vector<std::size_t> twin_;                // of each model, the same with GCV; 0: none
};

Comparer::Comparer(const ComparisonOptions& options, const Progress& progress)
    : options_(Completed(options)),
      progress_(progress),
      task_(options_.task),
      surrogate_(options_.runs.empty()),
      as_published_(surrogate_ && task_ != Task::kForce),
      seeds_(options_.seeds) {
  result_.options = options_;
  for (const PublishedModel& plan : ModelsOf(task_)) {
    ComparedModel model;
    model.plan = plan;
    if (options_.epochs > 0) {
      model.plan.training.epochs = std::min(model.plan.training.epochs, options_.epochs);
    }
    model.parameters = networks::CountParameters(plan);
    model.fair = Empty(seeds_);
    if (as_published_) {
      model.as_published = Empty(seeds_);
      model.published_pairs = Empty(seeds_);
    }
    result_.models.push_back(std::move(model));
  }
  models_ = result_.models.size();
  first_.resize(models_);
  twin_.assign(models_, 0);
  if (as_published_ && task_ == Task::kSea) {
    for (int size = 1; size <= options_.curve_sets; size *= 2) curve_sizes_.push_back(size);
  }
  // The longest trainings first, so that no thread waits long for the last one.
  dear_.resize(models_);
  for (std::size_t m = 0; m < models_; ++m) dear_[m] = m;
  std::stable_sort(dear_.begin(), dear_.end(), [&](std::size_t a, std::size_t b) {
    const auto cost = [&](std::size_t m) {
      const PublishedModel& plan = result_.models[m].plan;
      return plan.method == Method::kNet && plan.net.kind != Kind::kDense ? 1 : 0;
    };
    return cost(a) > cost(b);
  });

  // All jobs, for the progress bar.
  const std::size_t n = static_cast<std::size_t>(seeds_);
  set_jobs_ = surrogate_ ? n + 1 : 1;
  total_ = set_jobs_ + models_ * static_cast<std::size_t>(options_.trials);
  if (as_published_) total_ += models_ * (2 * n - 1);
  for (const ComparedModel& model : result_.models) {
    total_ += model.plan.method == Method::kReservoir ? 2 * n : n;
  }
  total_ += 2 * curve_sizes_.size() * static_cast<std::size_t>(options_.curve_seeds);
}

void Comparer::RunCounted(const std::vector<std::function<void()>>& jobs) {
  tools::RunJobs(jobs, options_.threads, [&](std::size_t done) {
    if (progress_) progress_(before_ + done, total_);
  });
  before_ += jobs.size();
}

void Comparer::MakeSets() {
  sets_.resize(set_jobs_);
  std::vector<std::function<void()>> jobs;
  for (std::size_t s = 0; s < set_jobs_; ++s) {
    jobs.push_back([&, s] {
      const std::uint64_t seed =
          options_.seed + (s + 1 == set_jobs_ ? kSearchSet : static_cast<std::uint64_t>(s));
      sets_[s] = surrogate_
                     ? MakeComparisonSet(
                           {MakeSurrogateRun(
                               {.task = task_, .duration_s = options_.duration_s, .seed = seed})},
                           task_, options_.period_s)
                     : MakeComparisonSet(options_.runs, task_, options_.period_s);
    });
  }
  RunCounted(jobs);
}

// The published settings: every seed on the first set, and seed s on set s.
void Comparer::TrainAsPublished() {
  std::vector<std::function<void()>> jobs;
  for (const std::size_t m : dear_) {
    for (int s = 0; s < seeds_; ++s) {
      jobs.push_back([&, m, s] {
        ComparedModel& model = result_.models[m];
        const TimedFit timed = FitTimed(model.plan, sets_[0].published, task_,
                                        options_.seed + static_cast<std::uint64_t>(s));
        Keep(&*model.as_published, s, timed);
        if (s == 0) {
          first_[m] = timed.fit.model;
          Keep(&*model.published_pairs, 0, timed);
        }
      });
      if (s == 0) continue;
      jobs.push_back([&, m, s] {
        ComparedModel& model = result_.models[m];
        Keep(&*model.published_pairs, s,
             FitTimed(model.plan, SetOf(s).published, task_,
                      options_.seed + static_cast<std::uint64_t>(s)));
      });
    }
  }
  RunCounted(jobs);
}

void Comparer::SearchHyperParameters() {
  const ComparisonSet& search_set = sets_.back();
  std::vector<std::function<void()>> jobs;
  const std::size_t trials = static_cast<std::size_t>(options_.trials);
  validation_.assign(models_, std::vector<double>(trials));
  for (const std::size_t m : dear_) {
    for (std::size_t k = 0; k < trials; ++k) {
      jobs.push_back([&, m, k] {
        const PublishedModel plan = DrawHyperParameters(result_.models[m].plan, static_cast<int>(k),
                                                        options_.seed + m, options_);
        const double error =
            FitTimed(plan, search_set.fair, task_, options_.seed + kSearchSet).fit.validation_mse;
        validation_[m][k] = std::isfinite(error) ? error : 1e300;
      });
    }
  }
  RunCounted(jobs);
}

// The same reservoirs with the ridge's strength by generalised cross-validation.
void Comparer::AddGcvTwins() {
  for (std::size_t m = 0; m < models_; ++m) {
    if (result_.models[m].plan.method != Method::kReservoir) continue;
    ComparedModel by_gcv;
    by_gcv.extra = true;
    by_gcv.plan.name = result_.models[m].plan.name + " (GCV)";
    by_gcv.fair = Empty(seeds_);
    by_gcv.fair_hyper = "the same, beta by GCV";
    by_gcv.parameters = result_.models[m].parameters;
    twin_[m] = result_.models.size();
    result_.models.push_back(std::move(by_gcv));
  }
}

void Comparer::TrainFairly() {
  // By model and seed, summed in order afterwards: no sum depends on the threads.
  const std::size_t seeds = static_cast<std::size_t>(seeds_);
  std::vector<std::vector<double>> quiet(result_.models.size(), std::vector<double>(seeds, 0.0));
  std::vector<std::vector<double>> busy = quiet;
  std::vector<std::function<void()>> jobs;
  for (const std::size_t m : dear_) {
    const std::size_t best = static_cast<std::size_t>(
        std::min_element(validation_[m].begin(), validation_[m].end()) - validation_[m].begin());
    const PublishedModel plan = DrawHyperParameters(result_.models[m].plan, static_cast<int>(best),
                                                    options_.seed + m, options_);
    result_.models[m].fair_hyper = HyperText(plan);
    for (int s = 0; s < seeds_; ++s) {
      jobs.push_back([&, m, s, plan] {
        ComparedModel& model = result_.models[m];
        const ComparisonSet& set = SetOf(s);
        const std::size_t at = static_cast<std::size_t>(s);
        const TimedFit timed =
            FitTimed(plan, set.fair, task_, options_.seed + static_cast<std::uint64_t>(s));
        Keep(&model.fair, s, timed);
        AddParts(set, timed.fit.predicted, set.fair, &quiet[m][at], &busy[m][at]);
        if (s == 0 && !as_published_) first_[m] = timed.fit.model;
      });
      if (twin_[m] == 0) continue;
      jobs.push_back([&, m, s, plan] {
        PublishedModel by_gcv = plan;
        by_gcv.reservoir.beta_by_validation = false;
        const ComparisonSet& set = SetOf(s);
        const std::size_t at = static_cast<std::size_t>(s);
        const TimedFit timed =
            FitTimed(by_gcv, set.fair, task_, options_.seed + static_cast<std::uint64_t>(s));
        ComparedModel& model = result_.models[twin_[m]];
        Keep(&model.fair, s, timed);
        AddParts(set, timed.fit.predicted, set.fair, &quiet[twin_[m]][at], &busy[twin_[m]][at]);
      });
    }
  }
  RunCounted(jobs);
  for (std::size_t m = 0; m < result_.models.size(); ++m) {
    for (std::size_t s = 0; s < seeds; ++s) {
      result_.models[m].quiet_mse += quiet[m][s] / seeds_;
      result_.models[m].busy_mse += busy[m][s] / seeds_;
    }
  }
}

// The two best of the published order on more and more sets of one specimen.
void Comparer::MeasureLearningCurve() {
  std::vector<std::size_t> order(models_);
  for (std::size_t m = 0; m < models_; ++m) order[m] = m;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return result_.models[a].plan.test_mse < result_.models[b].plan.test_mse;
  });
  result_.curve_best = result_.models[order[0]].plan.name;
  result_.curve_second = result_.models[order[1]].plan.name;
  std::vector<types::Run> sets_of_one(static_cast<std::size_t>(curve_sizes_.back()));
  std::vector<std::function<void()>> jobs;
  for (std::size_t s = 0; s < sets_of_one.size(); ++s) {
    jobs.push_back([&, s] {
      sets_of_one[s] = MakeSurrogateRun({.task = task_,
                                         .duration_s = options_.duration_s,
                                         .seed = options_.seed + 2 * kSearchSet + s,
                                         .specimen_seed = options_.seed});
    });
  }
  tools::RunJobs(jobs, options_.threads);
  const std::size_t curve_seeds = static_cast<std::size_t>(options_.curve_seeds);
  std::vector<Samples> samples;
  std::vector<std::vector<double>> first_mse, second_mse;
  for (const int size : curve_sizes_) {
    samples.push_back(
        networks::MakeSamples(networks::MakeTable({sets_of_one.begin(), sets_of_one.begin() + size},
                                                  {.task = task_, .period_s = options_.period_s})));
    first_mse.emplace_back(curve_seeds);
    second_mse.emplace_back(curve_seeds);
  }
  jobs.clear();
  for (std::size_t k = curve_sizes_.size(); k-- > 0;) {
    for (std::size_t s = 0; s < curve_seeds; ++s) {
      for (const bool second : {false, true}) {
        jobs.push_back([&, k, s, second] {
          (second ? second_mse : first_mse)[k][s] =
              FitTimed(result_.models[order[second ? 1 : 0]].plan, samples[k], task_,
                       options_.seed + s)
                  .fit.test_mse;
        });
      }
    }
  }
  RunCounted(jobs);
  for (std::size_t k = 0; k < curve_sizes_.size(); ++k) {
    CurvePoint point;
    point.sets = curve_sizes_[k];
    point.train_samples = static_cast<long>(samples[k].train.size());
    point.best_mse = identify::Mean(first_mse[k]);
    point.second_mse = identify::Mean(second_mse[k]);
    point.order = ComparePaired(first_mse[k], second_mse[k]);
    result_.curve.push_back(point);
  }
}

void Comparer::AddGreyBox() {
  ComparedModel grey;
  grey.extra = true;
  grey.plan.name = "grey box";
  grey.fair = Empty(seeds_);
  grey.fair_hyper = "none: least squares";
  if (as_published_) grey.as_published = Empty(seeds_);
  for (int s = 0; s < seeds_; ++s) {
    const ComparisonSet& set = SetOf(s);
    const auto fit = [&](const Samples& samples, Runs* runs) {
      const SteadyClock::time_point begin = SteadyClock::now();
      TimedFit timed;
      const networks::GreyBox model = networks::FitGreyBox(task_, samples, &timed.fit.predicted);
      timed.seconds = std::chrono::duration<double>(SteadyClock::now() - begin).count();
      timed.fit.train_mse = networks::MeanSquare(samples, timed.fit.predicted, samples.train);
      timed.fit.test_mse = networks::MeanSquare(samples, timed.fit.predicted, samples.test);
      Keep(runs, s, timed);
      grey.parameters = model.parameter_count();
      return timed.fit.predicted;
    };
    AddParts(set, fit(set.fair, &grey.fair), set.fair, &grey.quiet_mse, &grey.busy_mse);
    if (as_published_) fit(sets_[0].published, &*grey.as_published);
  }
  grey.quiet_mse /= seeds_;
  grey.busy_mse /= seeds_;
  result_.models.push_back(std::move(grey));
}

void Comparer::DescribeData() {
  const ComparisonSet& set = sets_[0];
  result_.train_samples = static_cast<long>(set.published.train.size());
  result_.test_samples = static_cast<long>(set.published.test.size());
  result_.duration_s = set.duration_s;
  std::vector<double> deviations;
  deviations.reserve(static_cast<std::size_t>(seeds_));
  for (int s = 0; s < seeds_; ++s) deviations.push_back(SetOf(s).deviation);
  result_.target_deviation = identify::Mean(deviations);
  const double variance = result_.target_deviation * result_.target_deviation;
  if (surrogate_) {
    result_.noise_floor = NoiseFloor(task_) / variance;
  } else {
    const Eigen::VectorXd targets = set.published.targets.row(0).transpose();
    result_.noise_floor = NoiseFromDifferences(targets);
  }
  for (const int t : set.published.test) {
    result_.quiet_share += set.quiet(t) / static_cast<double>(set.published.test.size());
  }
  result_.quiet = task_ == Task::kSea   ? "link at a stop of the play"
                  : task_ == Task::kPea ? "link slower than 0.3 rad/s"
                                        : "piston slower than 1 mm/s";
  result_.busy = task_ == Task::kSea ? "link moving between the stops" : "moving";
  if (surrogate_ && task_ == Task::kPea) {
    const types::Run constant = MakeSurrogateRun(
        {.task = task_, .duration_s = 20.0, .seed = options_.seed, .constant_torque = true});
    const ComparisonSet flat = MakeComparisonSet({constant}, task_, options_.period_s);
    result_.constant_torque_noise_share = NoiseFloor(task_) / (flat.deviation * flat.deviation);
  }
}

ComparisonResult Comparer::Run() {
  MakeSets();
  if (as_published_) TrainAsPublished();
  SearchHyperParameters();
  AddGcvTwins();
  TrainFairly();
  if (!curve_sizes_.empty()) MeasureLearningCurve();
  for (std::size_t m = 0; m < models_; ++m) {
    result_.models[m].step_us = StepTime_us(first_[m]);
    result_.models[m].parameters = first_[m].parameter_count();
  }
  AddGreyBox();
  DescribeData();
  if (as_published_) result_.order_published = Orders(result_.models, false);
  result_.order_fair = Orders(result_.models, true);
  result_.seconds = std::chrono::duration<double>(SteadyClock::now() - start_).count();
  return result_;
}

}  // namespace

ComparisonResult Compare(const ComparisonOptions& options, const Progress& progress) {
  return Comparer(options, progress).Run();
}

}  // namespace sinew::reproduction
