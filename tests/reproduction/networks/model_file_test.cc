#include "reproduction/networks/file/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::networks {
namespace {

using ::testing::HasSubstr;

Samples SomeSamples() {
  Samples samples;
  samples.inputs.resize(6, 200);
  samples.targets.resize(1, 200);
  for (int t = 0; t < 200; ++t) {
    for (int m = 0; m < 6; ++m) samples.inputs(m, t) = std::sin(0.05 * t * (m + 1.1));
    samples.targets(0, t) = samples.inputs(0, t) * samples.inputs(2, t);
    samples.first.push_back(0);
    samples.train.push_back(t);
  }
  samples.input = {Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6)};
  samples.output = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  return samples;
}

std::vector<Model> Trained(const Samples& samples) {
  std::vector<Model> models;
  for (PublishedModel plan : Table64()) {
    plan.training.epochs = 1;
    Model model = Fit(plan, samples, {4, 1, 3}, 2).model;
    model.task = "pea";
    model.inputs = {"a", "b", "c", "d", "e", "f"};
    model.target = "motor_torque_Nm";
    model.period_s = 0.0125;
    model.training_data_hash = "00ff";
    models.push_back(std::move(model));
  }
  return models;
}

TEST(ModelFile, WhatIsReadBackPredictsTheSameBits) {
  const Samples samples = SomeSamples();
  testing::TemporaryFolder folder;
  for (const Model& model : Trained(samples)) {
    const auto path = folder.path() / "model.json";
    SaveModel(path, model);
    const Model read = LoadModel(path);
    EXPECT_EQ((Predict(model, samples) - Predict(read, samples)).cwiseAbs().maxCoeff(), 0.0)
        << model.name;
    EXPECT_EQ(FormatModel(read), FormatModel(model));
    EXPECT_EQ(read.parameter_count(), model.parameter_count());
  }
}

TEST(ModelFile, BadFilesAreRefusedWithFileAndKey) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      (void)ParseModel(text, "m.json");
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  const std::string good = FormatModel(Trained(SomeSamples())[1]);
  EXPECT_EQ(message(good), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_THAT(message("{\n\n nonsense"), HasSubstr("m.json:3"));
  EXPECT_THAT(message(with("sinew-network/1", "sinew-network/9")), HasSubstr("schema"));
  EXPECT_THAT(message(with("\"memory\": 12", "\"memory\": \"x\"")), HasSubstr("net.memory"));
  EXPECT_THAT(message(with("\"memory\": 12", "\"memory\": 0")), HasSubstr("memory: 0"));
  EXPECT_THAT(message(with("\"lstm\"", "\"lsmt\"")), HasSubstr("net.kind"));
  EXPECT_THAT(message(with("\"task\"", "\"tusk\"")), HasSubstr("tusk"));
  EXPECT_THAT(message(with("\"hidden\": [\n   2", "\"hidden\": [\n   3")), HasSubstr("parameters"));
  EXPECT_THAT(message(with("\"period_s\": 0.0125", "\"period_s\": 0")), HasSubstr("period_s"));
}

}  // namespace
}  // namespace sinew::networks
