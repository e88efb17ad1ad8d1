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

// A place in the file, for messages: "weights.json: key 'bias[3]': ...".
struct Place {
  const std::string& file;
  std::string key;

  Place operator[](std::string_view child) const {
    return {file, key.empty() ? std::string(child) : key + "." + std::string(child)};
  }
  Place operator[](std::size_t index) const {
    return {file, key + "[" + std::to_string(index) + "]"};
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw UsageError(file + ": key '" + key + "': " + what);
  }
};

std::string Shown(const Json& json) {
  std::string text = json.is_array()    ? "an array"
                     : json.is_object() ? "an object"
                                        : types::JsonText(json);
  if (text.size() > 40) text = text.substr(0, 40) + "...";
  return text;
}

const Json& Member(const Json& object, const Place& place, std::string_view key) {
  const auto found = object.find(std::string(key));
  if (found == object.end()) place[key].Fail("missing, expected by schema " + std::string(kSchema));
  return *found;
}

void RejectOtherKeys(const Json& object, const Place& place,
                     std::initializer_list<std::string_view> known) {
  for (const auto& item : object.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      std::string names;
      for (const std::string_view name : known)
        names += (names.empty() ? "" : ", ") + std::string(name);
      place[item.key()].Fail("unknown, expected " + names);
    }
  }
}

void ExpectObject(const Json& json, const Place& place) {
  if (!json.is_object()) place.Fail(Shown(json) + ", expected an object");
}

double ReadNumber(const Json& json, const Place& place) {
  if (!json.is_number()) place.Fail(Shown(json) + ", expected a finite number");
  const double value = json.get<double>();
  if (!std::isfinite(value)) place.Fail("expected a finite number");
  return value;
}

int ReadInt(const Json& json, const Place& place) {
  if (!json.is_number_integer()) place.Fail(Shown(json) + ", expected a whole number");
  const bool fits = json.is_number_unsigned() ? json.get<std::uint64_t>() <= 1'000'000'000u
                                              : std::abs(json.get<std::int64_t>()) <= 1'000'000'000;
  if (!fits) place.Fail(Shown(json) + ", expected a whole number of at most 9 digits");
  return json.get<int>();
}

std::string ReadText(const Json& json, const Place& place) {
  if (!json.is_string()) place.Fail(Shown(json) + ", expected a text");
  return json.get<std::string>();
}

// Rows of equal length: expected.first x expected.second.
template <class Read>
void ReadRows(const Json& json, const Place& place, int rows, int columns, const Read& read) {
  if (!json.is_array() || json.size() != static_cast<std::size_t>(rows)) {
    place.Fail((json.is_array() ? std::to_string(json.size()) + " rows" : Shown(json)) +
               ", expected " + std::to_string(rows) + " rows of " + std::to_string(columns));
  }
  for (std::size_t r = 0; r < json.size(); ++r) {
    const Json& row = json[r];
    if (!row.is_array() || row.size() != static_cast<std::size_t>(columns)) {
      place[r].Fail((row.is_array() ? std::to_string(row.size()) + " numbers" : Shown(row)) +
                    ", expected " + std::to_string(columns));
    }
    for (std::size_t c = 0; c < row.size(); ++c) read(row[c], place[r][c], r, c);
  }
}

Eigen::MatrixXd ReadMatrix(const Json& json, const Place& place, int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  ReadRows(json, place, rows, columns,
           [&](const Json& number, const Place& at, std::size_t r, std::size_t c) {
             matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
                 ReadNumber(number, at);
           });
  return matrix;
}

Eigen::VectorXd ReadVector(const Json& json, const Place& place, int size) {
  if (!json.is_array() || json.size() != static_cast<std::size_t>(size)) {
    place.Fail((json.is_array() ? std::to_string(json.size()) + " numbers" : Shown(json)) +
               ", expected " + std::to_string(size));
  }
  Eigen::VectorXd vector(size);
  for (std::size_t i = 0; i < json.size(); ++i) {
    vector(static_cast<Eigen::Index>(i)) = ReadNumber(json[i], place[i]);
  }
  return vector;
}

Normalisation ReadNormalisation(const Json& json, const Place& place, int size) {
  ExpectObject(json, place);
  RejectOtherKeys(json, place, {"offset", "scale"});
  return {ReadVector(Member(json, place, "offset"), place["offset"], size),
          ReadVector(Member(json, place, "scale"), place["scale"], size)};
}

Weights Read(const Json& json, const std::string& file) {
  const Place top{file, ""};
  if (!json.is_object()) throw UsageError(file + ": " + Shown(json) + ", expected a JSON object");
  const std::string schema = ReadText(Member(json, top, "schema"), top["schema"]);
  if (schema != kSchema)
    top["schema"].Fail("'" + schema + "', expected '" + std::string(kSchema) + "'");
  RejectOtherKeys(json, top,
                  {"schema", "network", "target", "period_s", "seed", "hyper", "shape", "inputs",
                   "input", "output", "reservoir_column", "reservoir_value", "input_weight", "bias",
                   "readout", "ridge_beta", "training_data_hash"});
  const auto at = [&](std::string_view key) -> const Json& { return Member(json, top, key); };

  Weights w;
  w.network = ReadText(at("network"), top["network"]);
  w.target = ReadText(at("target"), top["target"]);
  w.period_s = ReadNumber(at("period_s"), top["period_s"]);
  if (!at("seed").is_number_unsigned())
    top["seed"].Fail(Shown(at("seed")) + ", expected a whole number, at least 0");
  w.hyper.seed = at("seed").get<std::uint64_t>();

  const Json& hyper = at("hyper");
  const Place hyper_place = top["hyper"];
  ExpectObject(hyper, hyper_place);
  RejectOtherKeys(hyper, hyper_place,
                  {"spectral_radius", "input_variance", "density", "leak", "input_limit"});
  const auto hyper_number = [&](std::string_view key) {
    return ReadNumber(Member(hyper, hyper_place, key), hyper_place[key]);
  };
  w.hyper.spectral_radius = hyper_number("spectral_radius");
  w.hyper.input_variance = hyper_number("input_variance");
  w.hyper.density = hyper_number("density");
  w.hyper.leak = hyper_number("leak");
  w.hyper.input_limit = hyper_number("input_limit");

  const Json& shape = at("shape");
  const Place shape_place = top["shape"];
  ExpectObject(shape, shape_place);
  RejectOtherKeys(shape, shape_place, {"neurons", "inputs", "outputs", "row_entries"});
  const auto count = [&](std::string_view key) {
    const int value = ReadInt(Member(shape, shape_place, key), shape_place[key]);
    if (value < 1 || value > 100000)
      shape_place[key].Fail(std::to_string(value) + ", expected 1 .. 100000");
    return value;
  };
  const int n = w.hyper.neurons = count("neurons");
  const int m = count("inputs");
  const int o = count("outputs");
  const int k = count("row_entries");

  const Json& inputs = at("inputs");
  const Place inputs_place = top["inputs"];
  if (!inputs.is_array() || inputs.size() != static_cast<std::size_t>(m)) {
    inputs_place.Fail("expected a list of " + std::to_string(m) + " inputs");
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Place place = inputs_place[i];
    ExpectObject(inputs[i], place);
    RejectOtherKeys(inputs[i], place, {"signal", "joint"});
    const std::string name = ReadText(Member(inputs[i], place, "signal"), place["signal"]);
    const std::optional<Signal> signal = SignalFromName(name);
    if (!signal)
      place["signal"].Fail("'" + name + "', expected one of " + std::string(SignalNames()));
    const int joint = ReadInt(Member(inputs[i], place, "joint"), place["joint"]);
    if (joint < 0 || joint >= types::kMaxJoints) {
      place["joint"].Fail(std::to_string(joint) + ", expected 0 .. " +
                          std::to_string(types::kMaxJoints - 1));
    }
    w.inputs.push_back({*signal, joint});
  }

  w.input = ReadNormalisation(at("input"), top["input"], m);
  w.output = ReadNormalisation(at("output"), top["output"], o);
  w.reservoir.rows = n;
  w.reservoir.entries = k;
  ReadRows(at("reservoir_column"), top["reservoir_column"], n, k,
           [&](const Json& number, const Place& place, std::size_t, std::size_t) {
             w.reservoir.column.push_back(ReadInt(number, place));
           });
  ReadRows(at("reservoir_value"), top["reservoir_value"], n, k,
           [&](const Json& number, const Place& place, std::size_t, std::size_t) {
             w.reservoir.value.push_back(ReadNumber(number, place));
           });
  w.input_weight = ReadMatrix(at("input_weight"), top["input_weight"], n, m);
  w.bias = ReadVector(at("bias"), top["bias"], n);
  w.readout = ReadMatrix(at("readout"), top["readout"], o, 1 + m + n);
  w.ridge_beta = ReadNumber(at("ridge_beta"), top["ridge_beta"]);
  w.training_data_hash = ReadText(at("training_data_hash"), top["training_data_hash"]);
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

// The parser's message says "line 3" somewhere in the middle.
std::string LineOf(const std::string& message) {
  const std::size_t at = message.find("line ");
  if (at == std::string::npos) return "";
  const std::size_t end = message.find_first_not_of("0123456789", at + 5);
  return ":" + message.substr(at + 5, end - at - 5);
}

}  // namespace

Weights ParseWeights(const std::string& text, const std::string& name) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw UsageError(name + LineOf(error.what()) +
                     ": no valid JSON, expected a weights file of schema " + std::string(kSchema));
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
