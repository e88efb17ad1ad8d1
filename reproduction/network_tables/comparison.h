// The published tables beside ours: every model trained ten times, as published and fairly.
//
// As published: same sizes, epochs, batches and rate; ten seeds on one data set for mean and
// standard deviation, and seed s on data set s for the order.
// Fair: every model gets the same number of trials for its own hyper-parameters (rate, batch,
// memory, dropout; spectral radius, leak, input variance), assessed by the validation error on a
// data set of its own; then seed s is trained on data set s until the validation error stops
// falling, the ridge by generalised cross-validation. Sizes stay as published.
//
// Every MSE is of targets normalised by mean and standard deviation of the training samples: a
// share of their variance. Differences are paired (same seed, same data set); their 95 % interval
// is Student's over the pairs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reproduction/networks/dataset/dataset.h"
#include "reproduction/networks/model.h"
#include "reproduction/networks/samples.h"

namespace sinew::reproduction {

struct ComparisonOptions {
  networks::Task task = networks::Task::kSea;
  int seeds = 10;
  int trials = 16;      // of hyper-parameters a model, in the fair table
  int epochs = 0;       // as published; above 0: at most these (the quick form)
  int fair_epochs = 0;  // 0: 1500 inside, 200 outside (eight times the samples), 400 for a cylinder
  int patience = 50;
  double duration_s = 0.0;  // of a surrogate set; 0: the whole experiment
  int curve_sets = 8;       // most sets of the learning curve; 0: none
  int curve_seeds = 5;
  int threads = 2;
  std::uint64_t seed = 1;  // of the first data set
  // Instead of the surrogate's sets: one data set for all seeds (then only the fair table).
  std::vector<types::Run> runs;
  double period_s = 1.0 / 80.0;
};

struct Runs {  // of one model in one table
  std::vector<double> train_mse;
  std::vector<double> test_mse;
  std::vector<double> seconds;  // of training
  std::vector<int> epochs;
  double Mean(const std::vector<double>& values) const;
  double Deviation(const std::vector<double>& values) const;
};

inline double TestMean(const Runs& runs) { return runs.Mean(runs.test_mse); }
inline double TestDeviation(const Runs& runs) { return runs.Deviation(runs.test_mse); }

struct ComparedModel {
  networks::PublishedModel plan;
  int parameters = 0;                   // of the fitted one
  bool extra = false;                   // not in the published table: grey box
  std::optional<Runs> as_published;     // ten seeds, first data set
  std::optional<Runs> published_pairs;  // seed s on data set s
  Runs fair;
  std::string fair_hyper;  // what the search chose
  double step_us = 0.0;    // one prediction
  // Mean squared error on parts of the test samples, fair, as a share of the whole variance; and
  // the share of samples in that part.
  double quiet_mse = 0.0, busy_mse = 0.0;
};

struct PairedOrder {          // of two models that follow each other in the published order
  std::string better, worse;  // as published
  double published_difference = 0.0;
  double mean = 0.0, low = 0.0, high = 0.0;  // worse - better, ours, 95 %
  int pairs = 0;
  std::string verdict;  // "as published", "reversed", "not distinguished"
};

// The two best of the published order, trained as published on more and more sets of one specimen.
struct CurvePoint {
  int sets = 0;
  long train_samples = 0;
  double best_mse = 0.0;  // test, mean over the seeds
  double second_mse = 0.0;
  PairedOrder order;
};

struct ComparisonResult {
  ComparisonOptions options;
  std::vector<ComparedModel> models;
  double noise_floor = 0.0;  // as a share of the variance of the targets
  long train_samples = 0, test_samples = 0;
  double duration_s = 0.0;
  double target_deviation = 0.0;  // in its own unit, mean over the sets
  std::string quiet, busy;        // what the two parts of the test samples are
  double quiet_share = 0.0;
  double constant_torque_noise_share = 0.0;  // pea: of the target's variance when constant
  std::vector<PairedOrder> order_published;  // from the as-published runs
  std::vector<PairedOrder> order_fair;
  std::string curve_best, curve_second;
  std::vector<CurvePoint> curve;  // inside the backlash only
  double seconds = 0.0;
};

// done, total: jobs.
using Progress = std::function<void(std::size_t done, std::size_t total)>;

// Throws std::invalid_argument.
ComparisonResult Compare(const ComparisonOptions& options, const Progress& progress = {});

// worse - better, Student's interval over the pairs.
PairedOrder ComparePaired(const std::vector<double>& better, const std::vector<double>& worse);

// The time of a prediction by a Stepper, us: the median of some repeats.
double StepTime_us(const networks::Model& model);

}  // namespace sinew::reproduction
