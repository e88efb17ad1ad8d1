#include "reproduction/networks/model.h"

#include <numeric>
#include <stdexcept>

namespace sinew::networks {
namespace {

std::vector<int> All(const Samples& samples) {
  std::vector<int> indices(static_cast<std::size_t>(samples.count()));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

Samples WithLinearBlock(const LinearModel& linear, const Samples& samples) {
  return AppendInput(samples, linear.Predict(samples));
}

}  // namespace

int Model::parameter_count() const {
  int count = linear ? linear->parameter_count() : 0;
  if (method == Method::kNet) count += static_cast<int>(parameters.size());
  if (method == Method::kReservoir) count += static_cast<int>(readout.size());
  return count;
}

void Model::Check() const {
  const auto require = [&](bool good, const std::string& what) {
    if (!good) throw std::invalid_argument("model " + name + ": " + what);
  };
  const int measured = static_cast<int>(inputs.size());
  require(measured >= 1, "inputs: none");
  require(input.offset.size() == measured && input.scale.size() == measured,
          "normalisation of " + std::to_string(input.offset.size()) + " inputs, expected " +
              std::to_string(measured));
  require(output.offset.size() >= 1 && output.offset.size() == output.scale.size(),
          "normalisation of the output missing");
  require(input.offset.allFinite() && output.offset.allFinite() && input.scale.allFinite() &&
              output.scale.allFinite() && (input.scale.array() > 0.0).all() &&
              (output.scale.array() > 0.0).all(),
          "normalisation not finite, or a scale not above 0");
  require(period_s > 0.0, "period_s: " + std::to_string(period_s) + ", expected above 0");
  require(method != Method::kLinear || linear, "linear coefficients missing");
  if (linear) {
    require(linear->taps >= 1 &&
                linear->coefficients.size() ==
                    static_cast<Eigen::Index>(linear->inputs.size()) * linear->taps &&
                linear->coefficients.allFinite(),
            "linear coefficients do not fit their inputs and taps");
    for (const int row : linear->inputs) {
      require(row >= 0 && row < measured, "linear input " + std::to_string(row));
    }
  }
  const int all = measured + (wiener() ? 1 : 0);
  if (method == Method::kNet) {
    net.Check();
    require(net.inputs == all, "network of " + std::to_string(net.inputs) + " inputs, expected " +
                                   std::to_string(all));
    require(parameters.size() == net.ParameterCount() && parameters.allFinite(),
            std::to_string(parameters.size()) + " parameters, expected " +
                std::to_string(net.ParameterCount()) + ", finite");
  }
  if (method == Method::kReservoir) {
    reservoir.Check();
    require(reservoir.input_count() == all, "reservoir of " +
                                                std::to_string(reservoir.input_count()) +
                                                " inputs, expected " + std::to_string(all));
    require(readout.cols() == reservoir.neurons() && readout.allFinite(),
            "readout of " + std::to_string(readout.cols()) + " neurons, expected " +
                std::to_string(reservoir.neurons()) + ", finite");
  }
}

FitResult Fit(const PublishedModel& plan, const Samples& samples,
              const std::vector<int>& linear_rows, std::uint64_t seed,
              const std::function<bool(const TrainProgress&)>& report) {
  FitResult result;
  Model& model = result.model;
  model.name = plan.name;
  model.method = plan.method;
  model.seed = seed;
  model.input = samples.input;
  model.output = samples.output;
  if (plan.wiener || plan.method == Method::kLinear) model.linear = FitLinear(samples, linear_rows);
  if (plan.method == Method::kLinear) {
    result.predicted = model.linear->Predict(samples).transpose();
  } else {
    const Samples more = plan.wiener ? WithLinearBlock(*model.linear, samples) : Samples();
    const Samples& seen = plan.wiener ? more : samples;
    if (plan.method == Method::kNet) {
      model.net = plan.net;
      Net<float> net(plan.net, seed);
      TrainConfig training = plan.training;
      training.seed = seed;
      result.training = Train(seen, training, &net, report);
      model.parameters = net.parameters();
      result.predicted.resize(samples.targets.rows(), samples.count());
      net.Predict(Data<float>(seen), All(seen), &result.predicted);
    } else {
      ReservoirConfig config = plan.reservoir;
      config.hyper.seed = seed;
      ReservoirModel fitted = FitReservoir(seen, config, &result.predicted);
      model.reservoir = std::move(fitted.weights);
      model.readout = std::move(fitted.readout);
      model.ridge_beta = fitted.ridge_beta;
    }
  }
  // The start of a reservoir from zero is neither fitted nor assessed.
  std::vector<int> assessed;
  for (const int t : samples.train) {
    const int age = t - samples.first[static_cast<std::size_t>(t)];
    if (plan.method != Method::kReservoir || age >= plan.reservoir.washout) assessed.push_back(t);
  }
  result.train_mse = MeanSquare(samples, result.predicted, assessed);
  result.validation_mse = MeanSquare(samples, result.predicted, samples.validation);
  result.test_mse = MeanSquare(samples, result.predicted, samples.test);
  return result;
}

Eigen::MatrixXd Predict(const Model& model, const Samples& samples) {
  if (model.method == Method::kLinear) return model.linear->Predict(samples).transpose();
  const Samples more = model.wiener() ? WithLinearBlock(*model.linear, samples) : Samples();
  const Samples& seen = model.wiener() ? more : samples;
  if (model.method == Method::kReservoir) {
    return model.readout * ReservoirStates(model.reservoir, seen);
  }
  Net<float> net(model.net, 1);
  net.parameters() = model.parameters;
  Eigen::MatrixXd predicted(model.net.outputs, samples.count());
  net.Predict(Data<float>(seen), All(seen), &predicted);
  return predicted;
}

}  // namespace sinew::networks
