// The loop closed on the biped: it squats by the drives' position loops with 4 kg that its model
// does not declare, and with noise in its sensors; close-loop names them from two recordings. By
// computed torque it tracks an order of magnitude better with the corrected model. Domains 184 to
// 187.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "components/model/actuator/file/model_file.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

const std::string kRobotFolder = SINEW_SOURCE_DIR "/robots/biped/";
constexpr double kUndeclared_kg = 4.0;
constexpr double kPlace_m[] = {-0.01, 0.02};  // on the torso; 0.03 forward it falls

std::string TextOf(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string Replaced(std::string text, const std::string& old_text, const std::string& new_text) {
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return at == std::string::npos ? text : text.replace(at, old_text.size(), new_text);
}

fs::path WriteText(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return file;
}

// robots/biped/world.yaml with sensors of that noise, in another folder.
fs::path NoisyWorld(const fs::path& folder, int seed) {
  std::string text = TextOf(kRobotFolder + "world.yaml");
  text = Replaced(text, "urdf: biped.urdf", "urdf: " + kRobotFolder + "biped.urdf");
  text = Replaced(text, "fall: {urdf: biped.urdf", "fall: {urdf: " + kRobotFolder + "biped.urdf");
  text = Replaced(text, "model: model.yaml", "model: " + kRobotFolder + "model.yaml");
  text = Replaced(text, "  imu: imu\n",
                  "  imu: imu\n  noise: {seed: " + std::to_string(seed) +
                      ", motor_current_A: 0.04, foot_force_N: 2, orientation_rad: 0.001, "
                      "angular_velocity_rad_s: 0.003}\n");
  return WriteText(folder / ("world_" + std::to_string(seed) + ".yaml"), text);
}

// The robot as it is: the declared model and the payload.
fs::path Truth(const fs::path& folder) {
  actuator::ModelFile file = actuator::LoadModelFile(kRobotFolder + "model.yaml");
  actuator::Payload payload;
  payload.link = "torso";
  payload.mass_kg = kUndeclared_kg;
  payload.position_m = {kPlace_m[0], kPlace_m[1], 0.0715};
  file.robot.payloads.push_back(payload);
  actuator::SaveModelFile(folder / "truth.yaml", file);
  return folder / "truth.yaml";
}

// Computed torque with PD gains that carry the payload: with the published ones (60, 1.0) the
// loaded robot falls whatever the model.
const std::string kStiffControl = kRobotFolder + "control_computed_torque_stiff.yaml";

struct SquatRun {
  fs::path recording;
  double mean_square_error_rad2 = 0.0;  // of all joints, while armed
};

// The published squats of the robot as it is. model: of the inverse dynamics and of control, by
// computed torque; empty: by the drives' position loops.
SquatRun Record(const fs::path& folder, const std::string& name, int seed, double depth_m,
                const fs::path& model, int domain) {
  const fs::path reference =
      WriteText(folder / (name + "_reference.yaml"),
                Replaced(Replaced(TextOf(kRobotFolder + "reference_benchmark.yaml"),
                                  "urdf: biped.urdf", "urdf: " + kRobotFolder + "biped.urdf"),
                         "depth_m: 0.4", "depth_m: " + std::to_string(depth_m)));
  const fs::path file = folder / (name + ".mcap");
  std::vector<std::string> arguments = {
      kSinew,
      "launch",
      kRobotFolder + (model.empty() ? "deploy_biped.yaml" : "deploy_biped_esn.yaml"),
      "--domain",
      std::to_string(domain),
      "--record",
      file.string(),
      "--set",
      "world.config=" + NoisyWorld(folder, seed).string(),
      "--set",
      "reference.config=" + reference.string(),
      "--arg",
      "world=--model",
      "--arg",
      "world=" + Truth(folder).string()};
  if (!model.empty()) {
    arguments.insert(arguments.end(), {"--set", "control.config=" + kStiffControl});
    for (const char* process : {"esn", "control"}) {
      arguments.insert(arguments.end(), {"--arg", std::string(process) + "=--model", "--arg",
                                         process + ("=" + model.string())});
    }
  }
  const Finished run = Run(arguments, 120s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  const Finished offline = Run({kSinew, "performance", file.string(), "--config",
                                kRobotFolder + "performance.yaml", "--json"});
  EXPECT_EQ(offline.exit_code, 0) << offline.error;
  const nlohmann::json json = nlohmann::json::parse(offline.output);
  return {file, json.at(0).at("robot").at("mean_square_error_rad2").get<double>()};
}

TEST(BipedCloseLoop, NamesAnUndeclaredPayloadAndTheCorrectedModelTracksBetter) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  const fs::path declared = kRobotFolder + "model.yaml", found = folder / "found";
  const SquatRun train = Record(folder, "train", 41, 0.4, {}, 184);
  const SquatRun held_out = Record(folder, "held_out", 42, 0.33, {}, 185);
  if (HasFailure()) return;
  const Finished closed = launch::Run(
      {kSinew, "close-loop", "--model", declared.string(), "--train", train.recording.string(),
       "--held-out", held_out.recording.string(), "--out", found.string()},
      120s);
  ASSERT_EQ(closed.exit_code, 0) << closed.output << closed.error;
  SCOPED_TRACE(closed.output);
  const nlohmann::json report = nlohmann::json::parse(TextOf(found / "report.json"));
  EXPECT_EQ(report.at("verdict"), "effect");
  ASSERT_EQ(report.at("effects").size(), 1u);
  const nlohmann::json& payload = report.at("effects").at(0).at("payload");
  EXPECT_NEAR(payload.at("mass_kg").get<double>(), kUndeclared_kg, 0.05 * kUndeclared_kg);
  EXPECT_EQ(payload.at("link"), "base");  // the torso is fixed to it
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(payload.at("position_m").at(axis).get<double>(), kPlace_m[axis], 0.02);
    EXPECT_TRUE(payload.at("position_excited").at(axis).get<bool>());
  }
  EXPECT_FALSE(payload.at("position_excited").at(2).get<bool>());
  const nlohmann::json& force = report.at("errors").at("held_out").at("force_z_N");
  EXPECT_LT(force.at("corrected").get<double>(), 0.5 * force.at("declared").get<double>());
  EXPECT_FALSE(TextOf(found / "report.html").empty());

  const actuator::RobotModel corrected = actuator::LoadRobotModel(found / "model.yaml");
  ASSERT_EQ(corrected.payloads.size(), 1u);
  EXPECT_FALSE(corrected.payloads.front().declared);
  const SquatRun before = Record(folder, "before", 43, 0.4, declared, 186);
  const SquatRun after = Record(folder, "after", 43, 0.4, found / "model.yaml", 187);
  std::printf("MSE %.3g rad2 with the declared model, %.3g with the corrected one\n",
              before.mean_square_error_rad2, after.mean_square_error_rad2);
  EXPECT_LT(after.mean_square_error_rad2, 0.1 * before.mean_square_error_rad2);
}

TEST(BipedCloseLoop, RefusesARecordingWithoutFeet) {
  const TemporaryFolder temporary;
  const std::string file = (temporary.path() / "stand.mcap").string();
  const Finished run = launch::Run({kSinew, "launch", kRobotFolder + "deploy_stand.yaml",
                                    "--domain", "187", "--duration", "1", "--record", file},
                                   60s);
  ASSERT_EQ(run.exit_code, 0) << run.output << run.error;
  const Finished closed =
      launch::Run({kSinew, "close-loop", "--model", kRobotFolder + "model.yaml", "--train", file,
                   "--held-out", file, "--out", (temporary.path() / "found").string()});
  EXPECT_EQ(closed.exit_code, 2);
  EXPECT_NE(closed.error.find("stand.mcap"), std::string::npos) << closed.error;
  EXPECT_NE(closed.error.find("'foot_force'"), std::string::npos) << closed.error;
  EXPECT_FALSE(fs::exists(temporary.path() / "found"));
}

}  // namespace
}  // namespace sinew::testing
