#include "components/learn/esn/file/weights_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "components/base/config/config.h"
#include "components/learn/esn/network.h"
#include "components/learn/esn/normal.h"

namespace sinew::esn {
namespace {

Weights SomeWeights() {
  Hyperparameters hyper;
  hyper.neurons = 20;
  hyper.seed = 12345678901234567890u;
  Weights weights = MakeWeights(hyper, 2, 2);
  NormalGenerator random(1);
  for (Eigen::Index i = 0; i < weights.readout.size(); ++i)
    weights.readout.data()[i] = random.Next() * 1e-7;
  weights.inputs = {{Signal::kReferencePosition, 0}, {Signal::kChamberPressure, 3}};
  weights.network = "pea";
  weights.target = "drive_torque_Nm";
  weights.period_s = 1.0 / 240.0;
  weights.input.offset << 0.1, 1.0 / 3.0;
  weights.ridge_beta = 0.01;
  weights.training_data_hash = "abc123";
  return weights;
}

std::string Message(const std::string& text) {
  try {
    ParseWeights(text, "w.json");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(WeightsFile, RoundTripGivesTheSameBits) {
  const Weights saved = SomeWeights();
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "sinew_weights_test.json";
  SaveWeights(path, saved);
  const Weights loaded = LoadWeights(path);
  EXPECT_EQ(loaded.network, saved.network);
  EXPECT_EQ(loaded.target, saved.target);
  EXPECT_EQ(loaded.period_s, saved.period_s);
  EXPECT_EQ(loaded.hyper.seed, saved.hyper.seed);
  EXPECT_EQ(loaded.hyper.leak, saved.hyper.leak);
  EXPECT_EQ(loaded.hyper.spectral_radius, saved.hyper.spectral_radius);
  EXPECT_EQ(loaded.hyper.input_variance, saved.hyper.input_variance);
  EXPECT_EQ(loaded.hyper.density, saved.hyper.density);
  EXPECT_EQ(loaded.hyper.input_limit, saved.hyper.input_limit);
  EXPECT_EQ(loaded.inputs, saved.inputs);
  EXPECT_EQ(loaded.input.offset, saved.input.offset);
  EXPECT_EQ(loaded.input.scale, saved.input.scale);
  EXPECT_EQ(loaded.output.offset, saved.output.offset);
  EXPECT_EQ(loaded.output.scale, saved.output.scale);
  EXPECT_EQ(loaded.reservoir.column, saved.reservoir.column);
  EXPECT_EQ(loaded.reservoir.value, saved.reservoir.value);
  EXPECT_EQ(loaded.input_weight, saved.input_weight);
  EXPECT_EQ(loaded.bias, saved.bias);
  EXPECT_EQ(loaded.readout, saved.readout);
  EXPECT_EQ(loaded.ridge_beta, saved.ridge_beta);
  EXPECT_EQ(loaded.training_data_hash, saved.training_data_hash);
  EXPECT_EQ(FormatWeights(loaded), FormatWeights(saved));
  std::filesystem::remove(path);
}

TEST(WeightsFile, NamesTheFileAndTheKeyOfEveryMistake) {
  const std::string good = FormatWeights(SomeWeights());
  EXPECT_EQ(Message(good), "accepted");
  EXPECT_EQ(Message("{\n\"schema\": \n"),
            "w.json:3: no valid JSON, expected a weights file of schema sinew-esn/1");
  EXPECT_EQ(
      Message(std::string(100000, '[')),
      "w.json:1: JSON of more than 100 levels, expected a weights file of schema sinew-esn/1");
  EXPECT_EQ(Message("[1]"), "w.json: an array, expected a JSON object");
  EXPECT_EQ(Message(Replaced(good, "sinew-esn/1", "sinew-esn/2")),
            "w.json: key 'schema': 'sinew-esn/2', expected 'sinew-esn/1'");
  EXPECT_EQ(Message(Replaced(good, "\"period_s\"", "\"period_ms\"")),
            "w.json: key 'period_ms': unknown, expected schema, network, target, period_s, seed, "
            "hyper, shape, "
            "inputs, input, output, reservoir_column, reservoir_value, input_weight, bias, "
            "readout, ridge_beta, "
            "training_data_hash");
  EXPECT_EQ(Message(Replaced(good, "\"ridge_beta\": 0.01,\n", "")),
            "w.json: key 'ridge_beta': missing, expected by schema sinew-esn/1");
  EXPECT_EQ(Message(Replaced(good, "\"bias\": [", "\"bias\": [null, ")),
            "w.json: key 'bias': 21 numbers, expected 20");
  EXPECT_EQ(Message(Replaced(good, "\"neurons\":20", "\"neurons\":21")),
            "w.json: key 'reservoir_column': 20 rows, expected 21 rows of 2");
  EXPECT_EQ(Message(Replaced(good, "reference_position_rad", "motor_current_A")).substr(0, 66),
            "w.json: key 'inputs[0].signal': 'motor_current_A', expected one of");
  EXPECT_EQ(Message(Replaced(good, "\"joint\":3", "\"joint\":12")),
            "w.json: key 'inputs[1].joint': 12, expected 0 .. 11");
  EXPECT_EQ(Message(Replaced(good, "\"leak\":0.066", "\"leak\":-1")),
            "w.json: leak: -1.000000, expected above 0, at most 1");
  EXPECT_EQ(Message(Replaced(good, "12345678901234567890", "-5")),
            "w.json: key 'seed': -5, expected a whole number, at least 0");
  EXPECT_EQ(Message(Replaced(good, "\"scale\":[1.0,1.0]", "\"scale\":[1.0,0.0]")),
            "w.json: input.scale: not positive everywhere");
}

TEST(WeightsFile, RefusesNumbersThatAreNotFinite) {
  const std::string good = FormatWeights(SomeWeights());
  const std::size_t bias = good.find("\"bias\": [") + 9;
  const std::size_t comma = good.find(',', bias);
  const auto with = [&](const std::string& number) {
    return Message(std::string(good).replace(bias, comma - bias, number));
  };
  EXPECT_EQ(with("null"), "w.json: key 'bias[0]': null, expected a finite number");
  EXPECT_EQ(with("\"1\""), "w.json: key 'bias[0]': \"1\", expected a finite number");
  EXPECT_THAT(with("NaN"), testing::MatchesRegex("w.json:[0-9]+: no valid JSON, .*"));
  EXPECT_THAT(with("1e999"), testing::MatchesRegex("w.json[:0-9]*: no valid JSON, .*"));
  Weights bad = SomeWeights();
  bad.readout(0, 0) = std::nan("");
  EXPECT_THROW(FormatWeights(bad), std::invalid_argument);
}

TEST(WeightsFile, NamesAFileThatIsNotThere) {
  try {
    LoadWeights("/nowhere/weights.json");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/nowhere/weights.json"));
  }
}

TEST(WeightsFile, TruncatedAnywhereItIsAOneLineError) {
  const std::string good = FormatWeights(SomeWeights());
  for (std::size_t length = 0; length + 3 < good.size(); length += 37) {
    const std::string message = Message(good.substr(0, length));
    EXPECT_THAT(message, testing::StartsWith("w.json")) << length;
    EXPECT_EQ(message.find('\n'), std::string::npos) << length;
  }
}

}  // namespace
}  // namespace sinew::esn
