#include "components/learn/esn/file/weights_file.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "components/base/config/config.h"
#include "components/base/types/joints.h"
#include "components/base/types/json_text.h"

namespace sinew::esn {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSchema = "sinew-esn/1";

// ---- reading

std::string Shown(const Json& json) {
  std::string text = json.is_array()    ? "an array"
                     : json.is_object() ? "an object"
                                        : types::JsonText(json);
  if (text.size() > 40) text = text.substr(0, 40) + "...";
  return text;
}

// A value and its place in the file, for messages: "weights.json: key 'bias[3]': ...".
struct Place {
  const Json& json;
  const std::string& file;
  std::string key;

  Place operator[](std::string_view child) const {
    const auto found = json.find(std::string(child));
    const bool there = found != json.end();
    Place place{there ? *found : json, file,
                key.empty() ? std::string(child) : key + "." + std::string(child)};
    if (!there) place.Fail("missing, expected by schema " + std::string(kSchema));
    return place;
  }
  Place operator[](std::size_t index) const {
    return {json[index], file, key + "[" + std::to_string(index) + "]"};
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw UsageError(file + ": key '" + key + "': " + what);
  }
};

void RejectOtherKeys(const Place& at, std::initializer_list<std::string_view> known) {
  for (const auto& item : at.json.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      std::string names;
      for (const std::string_view name : known)
        names += (names.empty() ? "" : ", ") + std::string(name);
      at[item.key()].Fail("unknown, expected " + names);
    }
  }
}

void ExpectObject(const Place& at, std::initializer_list<std::string_view> keys) {
  if (!at.json.is_object()) at.Fail(Shown(at.json) + ", expected an object");
  RejectOtherKeys(at, keys);
}

double ReadNumber(const Place& at) {
  if (!at.json.is_number()) at.Fail(Shown(at.json) + ", expected a finite number");
  const double value = at.json.get<double>();
  if (!std::isfinite(value)) at.Fail("expected a finite number");
  return value;
}

int ReadInt(const Place& at) {
  const Json& json = at.json;
  if (!json.is_number_integer()) at.Fail(Shown(json) + ", expected a whole number");
  const bool fits = json.is_number_unsigned() ? json.get<std::uint64_t>() <= 1'000'000'000u
                                              : std::abs(json.get<std::int64_t>()) <= 1'000'000'000;
  if (!fits) at.Fail(Shown(json) + ", expected a whole number of at most 9 digits");
  return json.get<int>();
}

std::string ReadText(const Place& at) {
  if (!at.json.is_string()) at.Fail(Shown(at.json) + ", expected a text");
  return at.json.get<std::string>();
}

void ExpectNumbers(const Place& at, int count, const char* what, const std::string& expected) {
  const Json& json = at.json;
  if (json.is_array() && json.size() == static_cast<std::size_t>(count)) return;
  at.Fail((json.is_array() ? std::to_string(json.size()) + what : Shown(json)) + ", expected " +
          std::to_string(count) + expected);
}

// Rows of equal length: rows x columns.
template <class Read>
void ReadRows(const Place& at, int rows, int columns, const Read& read) {
  ExpectNumbers(at, rows, " rows", " rows of " + std::to_string(columns));
  for (std::size_t r = 0; r < at.json.size(); ++r) {
    const Place row = at[r];
    ExpectNumbers(row, columns, " numbers", "");
    for (std::size_t c = 0; c < row.json.size(); ++c) read(row[c], r, c);
  }
}

Eigen::MatrixXd ReadMatrix(const Place& at, int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  ReadRows(at, rows, columns, [&](const Place& number, std::size_t r, std::size_t c) {
    matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = ReadNumber(number);
  });
  return matrix;
}

Eigen::VectorXd ReadVector(const Place& at, int size) {
  ExpectNumbers(at, size, " numbers", "");
  Eigen::VectorXd vector(size);
  for (std::size_t i = 0; i < at.json.size(); ++i) {
    vector(static_cast<Eigen::Index>(i)) = ReadNumber(at[i]);
  }
  return vector;
}

Normalisation ReadNormalisation(const Place& at, int size) {
  ExpectObject(at, {"offset", "scale"});
  return {ReadVector(at["offset"], size), ReadVector(at["scale"], size)};
}

void ReadHyper(const Place& at, Hyperparameters* hyper) {
  ExpectObject(at, {"spectral_radius", "input_variance", "density", "leak", "input_limit"});
  hyper->spectral_radius = ReadNumber(at["spectral_radius"]);
  hyper->input_variance = ReadNumber(at["input_variance"]);
  hyper->density = ReadNumber(at["density"]);
  hyper->leak = ReadNumber(at["leak"]);
  hyper->input_limit = ReadNumber(at["input_limit"]);
}

int ReadCount(const Place& at) {
  const int value = ReadInt(at);
  if (value < 1 || value > 100000) at.Fail(std::to_string(value) + ", expected 1 .. 100000");
  return value;
}

Input ReadInput(const Place& at) {
  ExpectObject(at, {"signal", "joint"});
  const std::string name = ReadText(at["signal"]);
  const std::optional<Signal> signal = SignalFromName(name);
  if (!signal) {
    at["signal"].Fail("'" + name + "', expected one of " + std::string(SignalNames()));
  }
  const int joint = ReadInt(at["joint"]);
  if (joint < 0 || joint >= types::kMaxJoints) {
    at["joint"].Fail(std::to_string(joint) + ", expected 0 .. " +
                     std::to_string(types::kMaxJoints - 1));
  }
  return {*signal, joint};
}

Weights Read(const Json& json, const std::string& file) {
  if (!json.is_object()) throw UsageError(file + ": " + Shown(json) + ", expected a JSON object");
  const Place top{json, file, ""};
  const std::string schema = ReadText(top["schema"]);
  if (schema != kSchema)
    top["schema"].Fail("'" + schema + "', expected '" + std::string(kSchema) + "'");
  RejectOtherKeys(top, {"schema", "network", "target", "period_s", "seed", "hyper", "shape",
                        "inputs", "input", "output", "reservoir_column", "reservoir_value",
                        "input_weight", "bias", "readout", "ridge_beta", "training_data_hash"});

  Weights w;
  w.network = ReadText(top["network"]);
  w.target = ReadText(top["target"]);
  w.period_s = ReadNumber(top["period_s"]);
  const Place seed = top["seed"];
  if (!seed.json.is_number_unsigned())
    seed.Fail(Shown(seed.json) + ", expected a whole number, at least 0");
  w.hyper.seed = seed.json.get<std::uint64_t>();
  ReadHyper(top["hyper"], &w.hyper);

  const Place shape = top["shape"];
  ExpectObject(shape, {"neurons", "inputs", "outputs", "row_entries"});
  const int n = w.hyper.neurons = ReadCount(shape["neurons"]);
  const int m = ReadCount(shape["inputs"]);
  const int o = ReadCount(shape["outputs"]);
  const int k = ReadCount(shape["row_entries"]);

  const Place inputs = top["inputs"];
  if (!inputs.json.is_array() || inputs.json.size() != static_cast<std::size_t>(m)) {
    inputs.Fail("expected a list of " + std::to_string(m) + " inputs");
  }
  for (std::size_t i = 0; i < inputs.json.size(); ++i) w.inputs.push_back(ReadInput(inputs[i]));

  w.input = ReadNormalisation(top["input"], m);
  w.output = ReadNormalisation(top["output"], o);
  w.reservoir.rows = n;
  w.reservoir.entries = k;
  ReadRows(top["reservoir_column"], n, k, [&](const Place& at, std::size_t, std::size_t) {
    w.reservoir.column.push_back(ReadInt(at));
  });
  ReadRows(top["reservoir_value"], n, k, [&](const Place& at, std::size_t, std::size_t) {
    w.reservoir.value.push_back(ReadNumber(at));
  });
  w.input_weight = ReadMatrix(top["input_weight"], n, m);
  w.bias = ReadVector(top["bias"], n);
  w.readout = ReadMatrix(top["readout"], o, 1 + m + n);
  w.ridge_beta = ReadNumber(top["ridge_beta"]);
  w.training_data_hash = ReadText(top["training_data_hash"]);
  try {
    w.Check();
  } catch (const std::invalid_argument& error) {
    throw UsageError(file + ": " + error.what());
  }
  return w;
}

// ---- writing

Json Row(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < row.size(); ++i) json.push_back(row(i));
  return json;
}

Json Vector(const Eigen::VectorXd& vector) { return Row(vector.transpose()); }

Json Rows(const Eigen::MatrixXd& matrix) {
  Json json = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) json.push_back(Row(matrix.row(r)));
  return json;
}

template <class Number>
Json Rows(const std::vector<Number>& values, int columns) {
  Json json = Json::array();
  const std::size_t width = static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i < values.size(); i += width) {
    json.push_back(
        Json(std::vector<Number>(values.begin() + static_cast<std::ptrdiff_t>(i),
                                 values.begin() + static_cast<std::ptrdiff_t>(i + width))));
  }
  return json;
}

// A key a line, and matrices a row a line.
std::string Layout(const Json& json) {
  std::string text = "{\n";
  bool first_key = true;
  for (const auto& item : json.items()) {
    if (!first_key) text += ",\n";
    first_key = false;
    text += "\"" + item.key() + "\": ";
    const Json& value = item.value();
    if (value.is_array() && !value.empty() && value.front().is_array()) {
      text += "[\n";
      for (std::size_t r = 0; r < value.size(); ++r) {
        text += types::JsonText(value[r]) + (r + 1 < value.size() ? ",\n" : "]");
      }
    } else {
      text += types::JsonText(value);
    }
  }
  return text + "\n}\n";
}

}  // namespace

Weights ParseWeights(const std::string& text, const std::string& name) {
  Json json;
  try {
    json = types::ParseJson<Json>(text, name);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what() + std::string(", expected a weights file of schema ") +
                     std::string(kSchema));
  }
  return Read(json, name);
}

Weights LoadWeights(const std::filesystem::path& path) {
  return ParseWeights(config::ReadFile(path), path.string());
}

std::string FormatWeights(const Weights& w) {
  w.Check();
  Json json;
  json["schema"] = kSchema;
  json["network"] = w.network;
  json["target"] = w.target;
  json["period_s"] = w.period_s;
  json["seed"] = w.hyper.seed;
  json["hyper"] = {{"spectral_radius", w.hyper.spectral_radius},
                   {"input_variance", w.hyper.input_variance},
                   {"density", w.hyper.density},
                   {"leak", w.hyper.leak},
                   {"input_limit", w.hyper.input_limit}};
  json["shape"] = {{"neurons", w.neurons()},
                   {"inputs", w.input_count()},
                   {"outputs", w.output_count()},
                   {"row_entries", w.reservoir.entries}};
  json["inputs"] = Json::array();
  for (const Input& input : w.inputs) {
    json["inputs"].push_back({{"signal", SignalName(input.signal)}, {"joint", input.joint}});
  }
  json["input"] = {{"offset", Vector(w.input.offset)}, {"scale", Vector(w.input.scale)}};
  json["output"] = {{"offset", Vector(w.output.offset)}, {"scale", Vector(w.output.scale)}};
  json["ridge_beta"] = w.ridge_beta;
  json["training_data_hash"] = w.training_data_hash;
  json["readout"] = Rows(w.readout);
  json["bias"] = Vector(w.bias);
  json["input_weight"] = Rows(w.input_weight);
  json["reservoir_column"] = Rows(w.reservoir.column, w.reservoir.entries);
  json["reservoir_value"] = Rows(w.reservoir.value, w.reservoir.entries);
  return Layout(json);
}

void SaveWeights(const std::filesystem::path& path, const Weights& weights) {
  config::WriteFileAtomically(path, FormatWeights(weights));
}

}  // namespace sinew::esn
