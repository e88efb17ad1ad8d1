#include "reproduction/networks/training.h"

#include <cmath>
#include <random>
#include <stdexcept>

namespace sinew::networks {

TrainOutcome Train(const Samples& samples, const TrainConfig& config, Net<float>* net,
                   const std::function<bool(const TrainProgress&)>& report) {
  if (config.epochs < 1 || config.batch < 1 || config.patience < 0) {
    throw std::invalid_argument(
        "training: expected epochs and batch at least 1, patience at least 0");
  }
  if (config.patience > 0 && samples.validation.empty()) {
    throw std::invalid_argument("training: a validation stop without validation samples");
  }
  const Data<float> data(samples);
  std::vector<int> order = samples.train;
  const std::size_t batch = static_cast<std::size_t>(config.batch);
  const bool whole = batch >= order.size();
  std::mt19937_64 bits(config.seed);
  Adam<float> adam(config.adam, net->parameters().size());

  TrainOutcome outcome;
  Net<float>::Vector best = net->parameters();
  double best_validation = std::numeric_limits<double>::infinity();
  for (int epoch = 1; epoch <= config.epochs; ++epoch) {
    if (!whole) {
      for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[bits() % i]);
    }
    double sum = 0.0;
    for (std::size_t start = 0; start < order.size(); start += batch) {
      const std::size_t size = std::min(batch, order.size() - start);
      const double loss =
          net->LossAndGradient(data, std::span<const int>(order).subspan(start, size));
      if (!std::isfinite(loss) || !net->gradient().allFinite()) {
        outcome.diverged = true;
        net->parameters() = best;
        return outcome;
      }
      sum += loss * static_cast<double>(size);
      adam.Step(net->gradient(), &net->parameters());
    }
    outcome.epochs = epoch;
    TrainProgress progress{epoch, sum / static_cast<double>(order.size()), 0.0};
    if (config.patience > 0) {
      progress.validation_mse = net->Loss(data, samples.validation);
      if (progress.validation_mse < best_validation) {
        best_validation = progress.validation_mse;
        best = net->parameters();
        outcome.best_epoch = epoch;
      }
    } else {
      best = net->parameters();
      outcome.best_epoch = epoch;
    }
    if (report && !report(progress)) break;
    if (config.patience > 0 && epoch - outcome.best_epoch >= config.patience) break;
  }
  net->parameters() = best;
  if (config.patience > 0) outcome.validation_mse = best_validation;
  return outcome;
}

}  // namespace sinew::networks
