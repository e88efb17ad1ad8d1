#include "reproduction/networks/file/model_file.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"

namespace sinew::networks {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSchema = "sinew-network/1";
constexpr std::string_view kMethods[] = {"linear", "net", "reservoir"};
constexpr std::string_view kKinds[] = {"dense", "lstm", "gru"};
constexpr std::string_view kActivations[] = {"tanh", "relu"};

template <typename Values>
Json List(const Values& values) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) list.push_back(values.data()[i]);
  return list;
}

// One object of the file.
class Reader {
 public:
  Reader(const Json& json, std::string file, std::string path)
      : json_(json), file_(std::move(file)), path_(std::move(path)) {
    if (!json_.is_object()) Fail("", "expected an object");
  }

  [[noreturn]] void Fail(const std::string& key, const std::string& what) const {
    const std::string whole = path_.empty() ? key : key.empty() ? path_ : path_ + "." + key;
    throw UsageError(file_ + ": key '" + whole + "': " + what);
  }
  bool Has(const std::string& key) const { return json_.contains(key); }
  const Json& At(const std::string& key) const {
    if (!json_.contains(key)) Fail(key, "missing, expected by schema " + std::string(kSchema));
    return json_.at(key);
  }
  Reader Object(const std::string& key) const {
    return {At(key), file_, path_.empty() ? key : path_ + "." + key};
  }
  std::string Text(const std::string& key) const {
    if (!At(key).is_string()) Fail(key, "expected text");
    return At(key).get<std::string>();
  }
  double Number(const std::string& key) const {
    if (!At(key).is_number() || !std::isfinite(At(key).get<double>())) {
      Fail(key, "expected a finite number");
    }
    return At(key).get<double>();
  }
  int Integer(const std::string& key) const {
    if (!At(key).is_number_integer()) Fail(key, "expected a whole number");
    return At(key).get<int>();
  }
  std::uint64_t Seed(const std::string& key) const {
    if (!At(key).is_number_unsigned()) Fail(key, "expected a whole number, at least 0");
    return At(key).get<std::uint64_t>();
  }
  std::vector<double> Numbers(const std::string& key) const {
    const Json& list = At(key);
    if (!list.is_array()) Fail(key, "expected an array of numbers");
    std::vector<double> values;
    for (const Json& value : list) {
      if (!value.is_number() || !std::isfinite(value.get<double>())) {
        Fail(key + "[" + std::to_string(values.size()) + "]", "expected a finite number");
      }
      values.push_back(value.get<double>());
    }
    return values;
  }
  Eigen::VectorXd Vector(const std::string& key) const {
    const std::vector<double> values = Numbers(key);
    return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                             static_cast<Eigen::Index>(values.size()));
  }
  Eigen::MatrixXd Matrix(const std::string& key, Eigen::Index rows, Eigen::Index columns) const {
    const std::vector<double> values = Numbers(key);
    if (rows < 0 || columns < 0 || static_cast<Eigen::Index>(values.size()) != rows * columns) {
      Fail(key,
           std::to_string(values.size()) + " numbers, expected " + std::to_string(rows * columns));
    }
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(values.data(), rows, columns);
  }
  std::vector<int> Integers(const std::string& key) const {
    std::vector<int> integers;
    for (const double value : Numbers(key)) {
      if (value != std::floor(value) || std::abs(value) > 1e9) {
        Fail(key, "expected whole numbers");
      }
      integers.push_back(static_cast<int>(value));
    }
    return integers;
  }
  template <std::size_t kCount>
  int Choice(const std::string& key, const std::string_view (&choices)[kCount]) const {
    const std::string text = Text(key);
    std::string names;
    for (std::size_t k = 0; k < kCount; ++k) {
      if (text == choices[k]) return static_cast<int>(k);
      names += (names.empty() ? "" : ", ") + std::string(choices[k]);
    }
    Fail(key, "'" + text + "', expected one of " + names);
  }
  void RejectOthers(std::initializer_list<std::string_view> known) const {
    for (const auto& item : json_.items()) {
      if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
        Fail(item.key(), "unknown, not of schema " + std::string(kSchema));
      }
    }
  }
  esn::Normalisation Normalisation(const std::string& key) const {
    const Reader section = Object(key);
    section.RejectOthers({"offset", "scale"});
    return {section.Vector("offset"), section.Vector("scale")};
  }

 private:
  const Json& json_;
  std::string file_;
  std::string path_;
};

Json RowMajor(const Eigen::MatrixXd& matrix) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
  return List(rows);
}

}  // namespace

std::string FormatModel(const Model& model) {
  Json json = {
      {"schema", kSchema},
      {"name", model.name},
      {"task", model.task},
      {"target", model.target},
      {"inputs", model.inputs},
      {"period_s", model.period_s},
      {"seed", model.seed},
      {"training_data_hash", model.training_data_hash},
      {"input", {{"offset", List(model.input.offset)}, {"scale", List(model.input.scale)}}},
      {"output", {{"offset", List(model.output.offset)}, {"scale", List(model.output.scale)}}},
      {"method", kMethods[static_cast<std::size_t>(model.method)]}};
  if (model.linear) {
    json["linear"] = {{"inputs", model.linear->inputs},
                      {"taps", model.linear->taps},
                      {"coefficients", List(model.linear->coefficients)}};
  }
  if (model.method == Method::kNet) {
    const Architecture& a = model.net;
    json["net"] = {{"kind", kKinds[static_cast<std::size_t>(a.kind)]},
                   {"inputs", a.inputs},
                   {"outputs", a.outputs},
                   {"memory", a.memory},
                   {"hidden", a.hidden},
                   {"activation", kActivations[static_cast<std::size_t>(a.activation)]},
                   {"dropout", a.dropout},
                   {"parameters", List(model.parameters)}};
  }
  if (model.method == Method::kReservoir) {
    const esn::Weights& w = model.reservoir;
    json["reservoir"] = {{"neurons", w.neurons()},
                         {"inputs", w.input_count()},
                         {"outputs", model.readout.rows()},
                         {"row_entries", w.reservoir.entries},
                         {"spectral_radius", w.hyper.spectral_radius},
                         {"input_variance", w.hyper.input_variance},
                         {"density", w.hyper.density},
                         {"leak", w.hyper.leak},
                         {"input_limit", w.hyper.input_limit},
                         {"seed", w.hyper.seed},
                         {"ridge_beta", model.ridge_beta},
                         {"readout", RowMajor(model.readout)},
                         {"bias", List(w.bias)},
                         {"input_weight", RowMajor(w.input_weight)},
                         {"column", w.reservoir.column},
                         {"value", w.reservoir.value}};
  }
  return types::JsonText(json, 1) + "\n";
}

Model ParseModel(const std::string& text, const std::string& name) {
  Json json;
  try {
    json = types::ParseJson<Json>(text, name);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what() + std::string(", expected schema ") + std::string(kSchema));
  }
  const Reader root(json, name, "");
  if (root.Text("schema") != kSchema) {
    root.Fail("schema", "'" + root.Text("schema") + "', expected " + std::string(kSchema));
  }
  root.RejectOthers({"schema", "name", "task", "target", "inputs", "period_s", "seed",
                     "training_data_hash", "input", "output", "method", "linear", "net",
                     "reservoir"});
  Model model;
  model.name = root.Text("name");
  model.task = root.Text("task");
  model.target = root.Text("target");
  const Json& inputs = root.At("inputs");
  if (!inputs.is_array()) root.Fail("inputs", "expected an array of names");
  for (const Json& input : inputs) {
    if (!input.is_string()) root.Fail("inputs", "expected an array of names");
    model.inputs.push_back(input.get<std::string>());
  }
  model.period_s = root.Number("period_s");
  model.seed = root.Seed("seed");
  model.training_data_hash = root.Text("training_data_hash");
  model.input = root.Normalisation("input");
  model.output = root.Normalisation("output");
  model.method = static_cast<Method>(root.Choice("method", kMethods));
  if (root.Has("linear")) {
    const Reader section = root.Object("linear");
    section.RejectOthers({"inputs", "taps", "coefficients"});
    model.linear = LinearModel{section.Integers("inputs"), section.Integer("taps"),
                               section.Vector("coefficients")};
  }
  if (model.method == Method::kNet) {
    const Reader section = root.Object("net");
    section.RejectOthers(
        {"kind", "inputs", "outputs", "memory", "hidden", "activation", "dropout", "parameters"});
    model.net.kind = static_cast<Kind>(section.Choice("kind", kKinds));
    model.net.inputs = section.Integer("inputs");
    model.net.outputs = section.Integer("outputs");
    model.net.memory = section.Integer("memory");
    model.net.hidden = section.Integers("hidden");
    model.net.activation = static_cast<Activation>(section.Choice("activation", kActivations));
    model.net.dropout = section.Number("dropout");
    model.parameters = section.Vector("parameters").cast<float>();
  }
  if (model.method == Method::kReservoir) {
    const Reader section = root.Object("reservoir");
    section.RejectOthers({"neurons", "inputs", "outputs", "row_entries", "spectral_radius",
                          "input_variance", "density", "leak", "input_limit", "seed", "ridge_beta",
                          "readout", "bias", "input_weight", "column", "value"});
    esn::Weights& w = model.reservoir;
    const int neurons = section.Integer("neurons");
    const int columns = section.Integer("inputs");
    const int outputs = section.Integer("outputs");
    w.hyper.neurons = neurons;
    w.hyper.spectral_radius = section.Number("spectral_radius");
    w.hyper.input_variance = section.Number("input_variance");
    w.hyper.density = section.Number("density");
    w.hyper.leak = section.Number("leak");
    w.hyper.input_limit = section.Number("input_limit");
    w.hyper.seed = section.Seed("seed");
    w.period_s = model.period_s;
    w.reservoir.rows = neurons;
    w.reservoir.entries = section.Integer("row_entries");
    w.reservoir.column = section.Integers("column");
    w.reservoir.value = section.Numbers("value");
    w.bias = section.Vector("bias");
    w.input_weight = section.Matrix("input_weight", neurons, columns);
    w.input = {Eigen::VectorXd::Zero(columns), Eigen::VectorXd::Ones(columns)};
    w.output = {Eigen::VectorXd::Zero(outputs), Eigen::VectorXd::Ones(outputs)};
    model.ridge_beta = section.Number("ridge_beta");
    model.readout = section.Matrix("readout", outputs, neurons);
    w.readout = Eigen::MatrixXd::Zero(outputs, w.feature_count());
  }
  try {
    model.Check();
  } catch (const std::invalid_argument& error) {
    throw UsageError(name + ": " + error.what());
  }
  return model;
}

Model LoadModel(const std::filesystem::path& path) {
  return ParseModel(config::ReadFile(path, config::kLargestData), path.string());
}

void SaveModel(const std::filesystem::path& path, const Model& model) {
  model.Check();
  config::WriteFileAtomically(path, FormatModel(model));
}

}  // namespace sinew::networks
