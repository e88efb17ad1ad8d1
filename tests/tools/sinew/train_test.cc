// `sinew train` warns of a network that is worse than none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using sinew::testing::Finished;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kWarning = "warning: on the test samples this network is worse than";

// 75 s of a sine at 80 Hz; the current is noise, or follows the angle.
std::string MotionCsv(bool noise) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::string csv = "t,q,i\n";
  for (int k = 0; k < 6000; ++k) {
    const double t = 0.0125 * k, q = std::sin(t);
    csv += std::to_string(t) + "," + std::to_string(q) + "," +
           std::to_string(noise ? normal(random) : 2.0 * q) + "\n";
  }
  return csv;
}

Finished Train(const testing::TemporaryFolder& folder, bool noise) {
  const std::string map = folder.Write(
      "map.yaml",
      "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n"
      "  position: {column: q, unit: rad}\n  motor_position: {column: q, unit: rad, scale: 100}\n"
      "  reference_position: {column: q, unit: rad}\n  motor_current: {column: i, unit: A}\n");
  const std::string config = folder.Write(
      "net.yaml",
      "schema: sinew-esn-train/1\nrate_Hz: 80\nnetworks:\n  - name: noise\n"
      "    target: drive_torque_Nm\n    region: all\n    inputs: [reference_position_rad]\n"
      "    neurons: 100\n    spectral_radius: 0.5\n    input_variance: 1\n    density: 0.1\n"
      "    leak: 0.4\n    washout_s: 1\n    seed: 1\n    ridge_beta: 1e-9\n");
  const std::string model = folder.Write(
      "model.yaml",
      "schema: sinew-model/1\nname: noise\njoints:\n  - name: j\n    kind: rotary\n"
      "    constants: {gear_ratio: 100, torque_constant_Nm_A: 0.01}\n    backlash_rad: 0.02\n"
      "    terms:\n      - {effect: drive_current, efficiency: 1}\n");
  return testing::Run({kSinew, "train", "--model", model, "--recording",
                       folder.Write("run.csv", MotionCsv(noise)), "--map", map, "--config", config,
                       "--network", "noise", "--out", (folder.path() / "out.json").string()});
}

TEST(SinewTrain, ANetworkThatIsWorseThanTheMeanIsWarnedOf) {
  const testing::TemporaryFolder folder;
  const Finished noise = Train(folder, true);
  ASSERT_EQ(noise.exit_code, 0) << noise.error;
  EXPECT_THAT(noise.error, HasSubstr(kWarning));
  const Finished motion = Train(folder, false);
  ASSERT_EQ(motion.exit_code, 0) << motion.error;
  EXPECT_THAT(motion.error, Not(HasSubstr(kWarning)));
}

TEST(SinewTrain, OtherNetworksSayItAsWell) {
  const Finished help = testing::Run({kSinew, "train", "--help"});
  if (help.output.find("--task") == std::string::npos) return;  // built without the reproduction
  const testing::TemporaryFolder folder;
  const Finished run = testing::Run({kSinew, "train", "--net", "linear", "--task", "sea", "--out",
                                     (folder.path() / "net.json").string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json["worse_than_mean"], json["test"]["mse_normalised"].get<double>() >= 1.0);
}

}  // namespace
}  // namespace sinew
