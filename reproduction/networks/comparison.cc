#include "reproduction/networks/comparison.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <random>
#include <stdexcept>

#include "components/identify/statistics.h"
#include "components/networks/grey_box.h"
#include "components/networks/stepper.h"
#include "reproduction/networks/jobs.h"
#include "tools/training_sets/training_sets.h"

namespace sinew::reproduction {
namespace {

using networks::FitResult;
using networks::Kind;
using networks::Method;
using networks::PublishedModel;
using networks::Samples;
using networks::Task;
using Clock = std::chrono::steady_clock;

// The data set on which hyper-parameters are chosen is none of those that are scored.
constexpr std::uint64_t kSearchSet = 1000;
// A recording of the cylinder is about ten cycles: ten blocks would keep the same part of every
// cycle for testing. Two blocks teach four cycles each, and a quarter of that is a whole cycle.
constexpr int kCylinderBlocks = 2;
constexpr double kCylinderValidationShare = 0.25;

struct Set {
  Samples published;      // all training samples teach
  Samples fair;           // the last fifth of every piece stops
  Eigen::VectorXd quiet;  // 1 where the sample belongs to the quiet part
  double deviation = 0.0;
  double duration_s = 0.0;
};

Set MakeSet(const std::vector<types::Run>& runs, Task task, double period_s) {
  const bool cylinder = task == Task::kForce;
  const std::vector<esn::Sequence> sequences = networks::MakeTable(
      runs, {.task = task, .period_s = period_s, .blocks = cylinder ? kCylinderBlocks : 10});
  Set set;
  set.published = networks::MakeSamples(sequences);
  set.fair = networks::MakeSamples(sequences,
                                   cylinder ? kCylinderValidationShare : tools::kValidationShare,
                                   cylinder ? 1 : tools::kGap);
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

double Uniform(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) * 0x1p-53; }
double LogUniform(std::mt19937_64& bits, double low, double high) {
  return low * std::pow(high / low, Uniform(bits));
}
template <typename T>
T Pick(std::mt19937_64& bits, std::initializer_list<T> values) {
  return values.begin()[bits() % values.size()];
}

// Trial 0 is the published setting (in batches), the others are drawn.
PublishedModel Vary(PublishedModel plan, int trial, std::uint64_t seed,
                    const ComparisonOptions& options) {
  std::mt19937_64 bits(seed * 7919 + static_cast<std::uint64_t>(trial));
  plan.training.epochs = options.fair_epochs;
  plan.training.patience = options.patience;
  plan.training.batch = 64;
  plan.reservoir.ridge_beta.reset();
  plan.reservoir.beta_by_validation = true;
  if (trial == 0) return plan;
  plan.training.adam.rate = LogUniform(bits, 5e-4, 1e-2);
  plan.training.batch = Pick(bits, {64, 128, 256, 512});
  if (plan.net.kind != Kind::kDense) plan.net.memory = Pick(bits, {6, 12, 18, 24});
  if (plan.net.dropout > 0.0) plan.net.dropout = Pick(bits, {0.0, 0.0, 0.1, 0.2});
  plan.reservoir.hyper.spectral_radius = 0.5 + 0.9 * Uniform(bits);
  plan.reservoir.hyper.leak = LogUniform(bits, 0.03, 1.0);
  plan.reservoir.hyper.input_variance = LogUniform(bits, 0.03, 3.0);
  return plan;
}

std::string HyperText(const PublishedModel& plan) {
  char text[160];
  switch (plan.method) {
    case Method::kLinear:
      return "none";
    case Method::kReservoir:
      std::snprintf(text, sizeof text, "rho %.3f, tau %.3f, alpha %.3f, beta by validation",
                    plan.reservoir.hyper.spectral_radius, plan.reservoir.hyper.leak,
                    plan.reservoir.hyper.input_variance);
      return text;
    case Method::kNet:
      std::snprintf(text, sizeof text, "rate %.2g, batch %d", plan.training.adam.rate,
                    plan.training.batch);
      break;
  }
  std::string all = text;
  if (plan.net.kind != Kind::kDense) all += ", memory " + std::to_string(plan.net.memory);
  if (plan.net.dropout > 0.0) {
    std::snprintf(text, sizeof text, ", dropout %.1f", plan.net.dropout);
    all += text;
  }
  return all;
}

std::vector<PublishedModel> ModelsOf(Task task) {
  if (task == Task::kPea) return networks::Table64();
  std::vector<PublishedModel> models = networks::Table62();
  if (task == Task::kForce) {
    PublishedModel linear;
    linear.name = "Linear";
    linear.method = Method::kLinear;
    linear.linear_inputs = 3;
    for (PublishedModel& model : models) model.train_mse = model.test_mse = 0.0;
    models.insert(models.begin(), linear);
  }
  return models;
}

struct Timed {
  FitResult fit;
  double seconds = 0.0;
};

Timed FitTimed(const PublishedModel& plan, const Samples& samples, Task task, std::uint64_t seed) {
  const Clock::time_point start = Clock::now();
  Timed timed{networks::Fit(plan, samples, networks::InfoOf(task).linear, seed), 0.0};
  timed.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  timed.fit.model.task = networks::InfoOf(task).name;
  for (const std::string_view name : networks::InfoOf(task).inputs) {
    timed.fit.model.inputs.emplace_back(name);
  }
  timed.fit.model.target = networks::InfoOf(task).target;
  timed.fit.model.period_s = 1.0 / 80.0;
  return timed;
}

void Keep(Runs* runs, int at, const Timed& timed) {
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

// Where on the test samples the error is.
void AddParts(const Set& set, const Eigen::MatrixXd& predicted, const Samples& samples,
              double* quiet, double* busy) {
  const double count = static_cast<double>(samples.test.size());
  for (const int t : samples.test) {
    const double error = (predicted.col(t) - samples.targets.col(t)).squaredNorm() / count;
    (set.quiet(t) > 0.0 ? *quiet : *busy) += error;
  }
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

}  // namespace

double Runs::Mean(const std::vector<double>& values) const { return identify::Mean(values); }
double Runs::Deviation(const std::vector<double>& values) const {
  return identify::StandardDeviation(values);
}

PairedOrder ComparePaired(const std::vector<double>& better, const std::vector<double>& worse) {
  if (better.size() != worse.size() || better.size() < 2) {
    throw std::invalid_argument("paired comparison: " + std::to_string(better.size()) + " and " +
                                std::to_string(worse.size()) +
                                " values, expected equally many, at least 2");
  }
  std::vector<double> differences;
  for (std::size_t k = 0; k < better.size(); ++k) differences.push_back(worse[k] - better[k]);
  PairedOrder order;
  order.pairs = static_cast<int>(differences.size());
  order.mean = identify::Mean(differences);
  const double half = identify::StudentQuantile(0.975, order.pairs - 1) *
                      identify::StandardDeviation(differences) / std::sqrt(order.pairs);
  order.low = order.mean - half;
  order.high = order.mean + half;
  order.verdict = order.low > 0.0    ? "as published"
                  : order.high < 0.0 ? "reversed"
                                     : "not told apart";
  return order;
}

double StepTime_us(const networks::Model& model) {
  networks::Stepper stepper(model);
  const Eigen::Index inputs = static_cast<Eigen::Index>(model.inputs.size());
  Eigen::MatrixXd u(inputs, 64);
  for (Eigen::Index t = 0; t < 64; ++t) {
    for (Eigen::Index m = 0; m < inputs; ++m) {
      u(m, t) = model.input.offset(m) +
                model.input.scale(m) * std::sin(0.1 * static_cast<double>(t * (m + 1)));
    }
  }
  constexpr int kRepeats = 9, kSteps = 512;
  std::vector<double> times;
  double sum = 0.0;
  for (int r = 0; r < kRepeats; ++r) {
    const Clock::time_point start = Clock::now();
    for (int t = 0; t < kSteps; ++t) sum += stepper.Step(u.col(t & 63));
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count() /
                    kSteps);
  }
  // Keeps the loop alive.
  return std::isnan(sum) ? sum : identify::Quantile(times, 0.5);
}

ComparisonResult Compare(const ComparisonOptions& given, const Progress& progress) {
  ComparisonOptions options = given;
  if (options.fair_epochs == 0) {
    options.fair_epochs = given.task == Task::kSea ? 1500 : given.task == Task::kPea ? 200 : 400;
  }
  if (options.seeds < 2 || options.trials < 1 || options.fair_epochs < 1 || options.patience < 1) {
    throw std::invalid_argument(
        "comparison: expected at least 2 seeds, 1 trial, 1 epoch, patience 1");
  }
  const Clock::time_point start = Clock::now();
  const Task task = options.task;
  const bool surrogate = options.runs.empty();
  const bool as_published = surrogate && task != Task::kForce;
  const int seeds = options.seeds;

  ComparisonResult result;
  result.options = options;
  for (const PublishedModel& plan : ModelsOf(task)) {
    ComparedModel model;
    model.plan = plan;
    if (options.epochs > 0) {
      model.plan.training.epochs = std::min(model.plan.training.epochs, options.epochs);
    }
    model.parameters = networks::CountParameters(plan);
    model.fair = Empty(seeds);
    if (as_published) {
      model.as_published = Empty(seeds);
      model.published_pairs = Empty(seeds);
    }
    result.models.push_back(std::move(model));
  }
  const std::size_t models = result.models.size();

  // Everything that will be done, for the bar.
  const std::size_t n = static_cast<std::size_t>(seeds);
  const std::size_t set_jobs = surrogate ? n + 1 : 1;
  const std::size_t published_jobs = as_published ? models * (2 * n - 1) : 0;
  const std::size_t search_jobs = models * static_cast<std::size_t>(options.trials);
  std::size_t fair_jobs = 0;
  for (const ComparedModel& model : result.models) {
    fair_jobs += model.plan.method == Method::kReservoir ? 2 * n : n;
  }
  std::vector<int> curve_sizes;
  if (as_published && task == Task::kSea) {
    for (int size = 1; size <= options.curve_sets; size *= 2) curve_sizes.push_back(size);
  }
  const std::size_t curve_jobs =
      2 * curve_sizes.size() * static_cast<std::size_t>(options.curve_seeds);
  const std::size_t total = set_jobs + published_jobs + search_jobs + fair_jobs + curve_jobs;
  std::size_t before = 0;
  const auto run = [&](const std::vector<std::function<void()>>& jobs) {
    RunJobs(jobs, options.threads, [&](std::size_t done) {
      if (progress) progress(before + done, total);
    });
    before += jobs.size();
  };

  std::vector<Set> sets(set_jobs);  // the last one is for the search
  std::vector<std::function<void()>> jobs;
  for (std::size_t s = 0; s < set_jobs; ++s) {
    jobs.push_back([&, s] {
      const std::uint64_t seed =
          options.seed + (s + 1 == set_jobs ? kSearchSet : static_cast<std::uint64_t>(s));
      sets[s] = surrogate
                    ? MakeSet({tools::MakeSurrogateRun(
                                  {.task = task, .duration_s = options.duration_s, .seed = seed})},
                              task, options.period_s)
                    : MakeSet(options.runs, task, options.period_s);
    });
  }
  run(jobs);
  const auto set_of = [&](int seed) -> const Set& {
    return sets[surrogate ? static_cast<std::size_t>(seed) : 0];
  };
  const Set& search_set = sets.back();

  // The dearest first, so that no thread waits long for the last one.
  std::vector<std::size_t> dear(models);
  for (std::size_t m = 0; m < models; ++m) dear[m] = m;
  std::stable_sort(dear.begin(), dear.end(), [&](std::size_t a, std::size_t b) {
    const auto cost = [&](std::size_t m) {
      const PublishedModel& plan = result.models[m].plan;
      return plan.method == Method::kNet && plan.net.kind != Kind::kDense ? 1 : 0;
    };
    return cost(a) > cost(b);
  });

  std::vector<networks::Model> first(models);  // for the time of a step
  jobs.clear();
  if (as_published) {
    for (const std::size_t m : dear) {
      for (int s = 0; s < seeds; ++s) {
        jobs.push_back([&, m, s] {
          ComparedModel& model = result.models[m];
          const Timed timed = FitTimed(model.plan, sets[0].published, task,
                                       options.seed + static_cast<std::uint64_t>(s));
          Keep(&*model.as_published, s, timed);
          if (s == 0) {
            first[m] = timed.fit.model;
            Keep(&*model.published_pairs, 0, timed);
          }
        });
        if (s == 0) continue;
        jobs.push_back([&, m, s] {
          ComparedModel& model = result.models[m];
          Keep(&*model.published_pairs, s,
               FitTimed(model.plan, set_of(s).published, task,
                        options.seed + static_cast<std::uint64_t>(s)));
        });
      }
    }
    run(jobs);
  }

  const std::size_t trials = static_cast<std::size_t>(options.trials);
  std::vector<std::vector<double>> validation(models, std::vector<double>(trials));
  jobs.clear();
  for (const std::size_t m : dear) {
    for (std::size_t k = 0; k < trials; ++k) {
      jobs.push_back([&, m, k] {
        const PublishedModel plan =
            Vary(result.models[m].plan, static_cast<int>(k), options.seed + m, options);
        const double error =
            FitTimed(plan, search_set.fair, task, options.seed + kSearchSet).fit.validation_mse;
        validation[m][k] = std::isfinite(error) ? error : 1e300;
      });
    }
  }
  run(jobs);

  // The same reservoirs with the ridge's strength by generalised cross-validation.
  std::vector<std::size_t> twin(models, 0);
  for (std::size_t m = 0; m < models; ++m) {
    if (result.models[m].plan.method != Method::kReservoir) continue;
    ComparedModel by_gcv;
    by_gcv.extra = true;
    by_gcv.plan.name = result.models[m].plan.name + " (GCV)";
    by_gcv.fair = Empty(seeds);
    by_gcv.fair_hyper = "the same, beta by GCV";
    by_gcv.parameters = result.models[m].parameters;
    twin[m] = result.models.size();
    result.models.push_back(std::move(by_gcv));
  }

  std::mutex mutex;
  jobs.clear();
  for (const std::size_t m : dear) {
    const std::size_t best = static_cast<std::size_t>(
        std::min_element(validation[m].begin(), validation[m].end()) - validation[m].begin());
    const PublishedModel plan =
        Vary(result.models[m].plan, static_cast<int>(best), options.seed + m, options);
    result.models[m].fair_hyper = HyperText(plan);
    for (int s = 0; s < seeds; ++s) {
      jobs.push_back([&, m, s, plan] {
        ComparedModel& model = result.models[m];
        const Set& set = set_of(s);
        const Timed timed =
            FitTimed(plan, set.fair, task, options.seed + static_cast<std::uint64_t>(s));
        Keep(&model.fair, s, timed);
        double quiet = 0.0, busy = 0.0;
        AddParts(set, timed.fit.predicted, set.fair, &quiet, &busy);
        const std::lock_guard lock(mutex);
        model.quiet_mse += quiet / seeds;
        model.busy_mse += busy / seeds;
        if (s == 0 && !as_published) first[m] = timed.fit.model;
      });
      if (twin[m] == 0) continue;
      jobs.push_back([&, m, s, plan] {
        PublishedModel by_gcv = plan;
        by_gcv.reservoir.beta_by_validation = false;
        const Set& set = set_of(s);
        const Timed timed =
            FitTimed(by_gcv, set.fair, task, options.seed + static_cast<std::uint64_t>(s));
        ComparedModel& model = result.models[twin[m]];
        Keep(&model.fair, s, timed);
        double quiet = 0.0, busy = 0.0;
        AddParts(set, timed.fit.predicted, set.fair, &quiet, &busy);
        const std::lock_guard lock(mutex);
        model.quiet_mse += quiet / seeds;
        model.busy_mse += busy / seeds;
      });
    }
  }
  run(jobs);

  if (!curve_sizes.empty()) {
    std::vector<std::size_t> order(models);
    for (std::size_t m = 0; m < models; ++m) order[m] = m;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return result.models[a].plan.test_mse < result.models[b].plan.test_mse;
    });
    result.curve_best = result.models[order[0]].plan.name;
    result.curve_second = result.models[order[1]].plan.name;
    std::vector<types::Run> sets_of_one(static_cast<std::size_t>(curve_sizes.back()));
    jobs.clear();
    for (std::size_t s = 0; s < sets_of_one.size(); ++s) {
      jobs.push_back([&, s] {
        sets_of_one[s] = tools::MakeSurrogateRun({.task = task,
                                                  .duration_s = options.duration_s,
                                                  .seed = options.seed + 2 * kSearchSet + s,
                                                  .specimen_seed = options.seed});
      });
    }
    RunJobs(jobs, options.threads);
    const std::size_t curve_seeds = static_cast<std::size_t>(options.curve_seeds);
    std::vector<Samples> samples;
    std::vector<std::vector<double>> first_mse, second_mse;
    for (const int size : curve_sizes) {
      samples.push_back(networks::MakeSamples(
          networks::MakeTable({sets_of_one.begin(), sets_of_one.begin() + size},
                              {.task = task, .period_s = options.period_s})));
      first_mse.emplace_back(curve_seeds);
      second_mse.emplace_back(curve_seeds);
    }
    jobs.clear();
    for (std::size_t k = curve_sizes.size(); k-- > 0;) {
      for (std::size_t s = 0; s < curve_seeds; ++s) {
        for (const bool second : {false, true}) {
          jobs.push_back([&, k, s, second] {
            (second ? second_mse : first_mse)[k][s] =
                FitTimed(result.models[order[second ? 1 : 0]].plan, samples[k], task,
                         options.seed + s)
                    .fit.test_mse;
          });
        }
      }
    }
    run(jobs);
    for (std::size_t k = 0; k < curve_sizes.size(); ++k) {
      CurvePoint point;
      point.sets = curve_sizes[k];
      point.train_samples = static_cast<long>(samples[k].train.size());
      point.best_mse = identify::Mean(first_mse[k]);
      point.second_mse = identify::Mean(second_mse[k]);
      point.order = ComparePaired(first_mse[k], second_mse[k]);
      result.curve.push_back(point);
    }
  }

  for (std::size_t m = 0; m < models; ++m) {
    result.models[m].step_us = StepTime_us(first[m]);
    result.models[m].parameters = first[m].parameter_count();
  }

  ComparedModel grey;
  grey.extra = true;
  grey.plan.name = "grey box";
  grey.fair = Empty(seeds);
  grey.fair_hyper = "none: least squares";
  if (as_published) grey.as_published = Empty(seeds);
  for (int s = 0; s < seeds; ++s) {
    const Set& set = set_of(s);
    const auto fit = [&](const Samples& samples, Runs* runs) {
      const Clock::time_point begin = Clock::now();
      Timed timed;
      const networks::GreyBox model = networks::FitGreyBox(task, samples, &timed.fit.predicted);
      timed.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      timed.fit.train_mse = networks::MeanSquare(samples, timed.fit.predicted, samples.train);
      timed.fit.test_mse = networks::MeanSquare(samples, timed.fit.predicted, samples.test);
      Keep(runs, s, timed);
      grey.parameters = model.parameter_count();
      return timed.fit.predicted;
    };
    AddParts(set, fit(set.fair, &grey.fair), set.fair, &grey.quiet_mse, &grey.busy_mse);
    if (as_published) fit(sets[0].published, &*grey.as_published);
  }
  grey.quiet_mse /= seeds;
  grey.busy_mse /= seeds;
  result.models.push_back(std::move(grey));

  const Set& set = sets[0];
  result.train_samples = static_cast<long>(set.published.train.size());
  result.test_samples = static_cast<long>(set.published.test.size());
  result.duration_s = set.duration_s;
  std::vector<double> deviations;
  for (int s = 0; s < seeds; ++s) deviations.push_back(set_of(s).deviation);
  result.target_deviation = identify::Mean(deviations);
  const double variance = result.target_deviation * result.target_deviation;
  if (surrogate) {
    result.noise_floor = tools::NoiseFloor(task) / variance;
  } else {
    const Eigen::VectorXd targets = set.published.targets.row(0).transpose();
    result.noise_floor = tools::NoiseFromDifferences(targets);
  }
  for (const int t : set.published.test) {
    result.quiet_share += set.quiet(t) / static_cast<double>(set.published.test.size());
  }
  result.quiet = task == Task::kSea   ? "link at a stop of the play"
                 : task == Task::kPea ? "link slower than 0.3 rad/s"
                                      : "piston slower than 1 mm/s";
  result.busy = task == Task::kSea ? "link moving between the stops" : "moving";
  if (surrogate && task == Task::kPea) {
    const types::Run constant = tools::MakeSurrogateRun(
        {.task = task, .duration_s = 20.0, .seed = options.seed, .constant_torque = true});
    const Set flat = MakeSet({constant}, task, options.period_s);
    result.constant_torque_noise_share =
        tools::NoiseFloor(task) / (flat.deviation * flat.deviation);
  }
  if (as_published) result.order_published = Orders(result.models, false);
  result.order_fair = Orders(result.models, true);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace sinew::reproduction
