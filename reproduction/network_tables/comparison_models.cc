#include "reproduction/network_tables/comparison_models.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

namespace sinew::reproduction {

using networks::Kind;
using networks::Method;
using networks::PublishedModel;
using networks::Samples;
using networks::Task;

namespace {

double Uniform(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) * 0x1p-53; }
double LogUniform(std::mt19937_64& bits, double low, double high) {
  return low * std::pow(high / low, Uniform(bits));
}
template <typename T>
T Pick(std::mt19937_64& bits, std::initializer_list<T> values) {
  return values.begin()[bits() % values.size()];
}

}  // namespace

PublishedModel DrawHyperParameters(PublishedModel plan, int trial, std::uint64_t seed,
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

TimedFit FitTimed(const PublishedModel& plan, const Samples& samples, Task task,
                  std::uint64_t seed) {
  const auto start = std::chrono::steady_clock::now();
  TimedFit timed{networks::Fit(plan, samples, networks::InfoOf(task).linear, seed), 0.0};
  timed.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  timed.fit.model.task = networks::InfoOf(task).name;
  for (const std::string_view name : networks::InfoOf(task).inputs) {
    timed.fit.model.inputs.emplace_back(name);
  }
  timed.fit.model.target = networks::InfoOf(task).target;
  timed.fit.model.period_s = 1.0 / 80.0;
  return timed;
}

}  // namespace sinew::reproduction
