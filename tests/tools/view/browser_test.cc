// The page in a real Chromium. Not in tools/test: the browser's packages are 115 MB to fetch and
// 368 MB installed. It wants a machine that does nothing else: the rig runs in real time, and a
// browser without a GPU draws on the CPU.
//   tools/test --browser
// Pictures are left in build/release/tests/tools/view. Domains 223 and 224.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
const std::string kBrowserRobots = SINEW_SOURCE_DIR "/robots/";
constexpr double kRate_Hz = 240.0;
constexpr double kSignals = 20.0;
constexpr double kTopicsRead = 14.0;  // by the page, plotted or not: a second may be on its way
// Of one core, for 20 signals at 240 Hz, the robot's picture apart. Plots are drawn 20 times a
// second (tools/view/page/main.js), and less often when that takes more than a quarter of the time:
// a page that draws half as often does not cost little.
constexpr double kMostTaskShare = 0.30;
constexpr double kLeastDraws_Hz = 10.0;

bool HasBrowser() {
  return Run({"node", "--version"}).exit_code == 0 &&
         Run({"sh", "-c", "command -v chromium"}).exit_code == 0;
}

std::string AddressIn(Program* view) {
  if (!view->WaitForText("page and Foxglove WebSocket at", 30s)) return {};
  static const std::regex kAddress(R"(at (http://127\.0\.0\.1:\d+/))");
  const std::string log = view->output() + view->error();
  std::smatch match;
  return std::regex_search(log, match, kAddress) ? match[1] : std::string();
}

nlohmann::json Open(const std::string& address, const std::string& seconds,
                    const std::string& picture, const std::string& button = "") {
  std::vector<std::string> line = {"node", SINEW_SOURCE_DIR "/tests/tools/view/browser.mjs",
                                   address, seconds, SINEW_PICTURES "/" + picture};
  if (!button.empty()) line.push_back(button);
  const Finished run = Run(line, 150s);
  EXPECT_EQ(run.exit_code, 0) << run.error << run.output;
  const bool whole = nlohmann::json::accept(run.output);
  EXPECT_TRUE(whole) << run.output;
  std::printf("%s: %s", picture.c_str(), run.output.c_str());
  return whole ? nlohmann::json::parse(run.output) : nlohmann::json::object();
}

// At 1400, 900 and 400 px, light and dark; pictures are NAME_WIDTH_SCHEME.png.
void ExpectNothingIsCut(const std::string& address, const std::string& name) {
  const Finished run = Run({"node", SINEW_SOURCE_DIR "/tests/tools/view/layout_check.mjs", address,
                            SINEW_PICTURES "/" + name},
                           150s);
  EXPECT_EQ(run.exit_code, 0) << name << ": " << run.error << run.output;
}

TEST(ViewBrowser, NoTextIsCutOrOverlapsWhileTheRobotIsAbsent) {
  SKIP_WITHOUT_PACKAGE(HasBrowser(), "chromium");
  Program view({kSinew, "view", "--domain", "223", "--port", "0", "--allow-arming", "--config",
                kBrowserRobots + "rig/view.yaml"});
  const std::string address = AddressIn(&view);
  ASSERT_NE(address, "") << view.error();
  ExpectNothingIsCut(address, "absent");
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(30s), 0);
}

TEST(ViewBrowser, NoTextIsCutOrOverlapsWhileTheRigRuns) {
  SKIP_WITHOUT_PACKAGE(HasBrowser(), "chromium");
  Program rig({kSinew, "launch", kBrowserRobots + "rig/deploy_rig.yaml", "--duration", "0", "--set",
               "domain_id=223"});
  ASSERT_TRUE(rig.WaitForText("surrogate", 60s));
  Program view({kSinew, "view", "--domain", "223", "--port", "0", "--allow-arming", "--config",
                kBrowserRobots + "rig/view.yaml"});
  const std::string address = AddressIn(&view);
  ASSERT_NE(address, "") << view.error();
  // Three units, and a name that is refused.
  ExpectNothingIsCut(address +
                         "?signals=joint_state.velocity_rad_s[0],actuator_state.motor_current_A[0],"
                         "actuator_state.reservoir_pressure_bar[0],joint_stat.position_rad[0]",
                     "running");
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(30s), 0);
  rig.Signal(SIGINT);
  rig.Wait(30s);
}

TEST(ViewBrowser, TwentySignalsAt240HzArriveWholeAndCostLittle) {
  SKIP_WITHOUT_PACKAGE(HasBrowser(), "chromium");
  Program rig({kSinew, "launch", kBrowserRobots + "rig/deploy_rig.yaml", "--duration", "0", "--set",
               "domain_id=223"});
  ASSERT_TRUE(rig.WaitForText("surrogate", 60s));
  Program view({kSinew, "view", "--domain", "223", "--port", "0"});
  const std::string address = AddressIn(&view);
  ASSERT_NE(address, "") << view.error();
  std::string signals;
  for (const char* signal :
       {"joint_state.velocity_rad_s[0]", "reference.velocity_rad_s[0]",
        "reference.acceleration_rad_s2[0]", "joint_command.motor_torque_Nm[0]",
        "joint_command.position_rad[0]", "actuator_state.motor_position_rad[0]",
        "actuator_state.motor_velocity_rad_s[0]", "actuator_state.motor_current_A[0]",
        "actuator_state.reservoir_pressure_bar[0]", "actuator_state.load_force_N[0]",
        "regime.play_angle_rad[0]", "regime.confidence[0]", "torque_prediction.sea_torque_Nm[0]",
        "torque_prediction.pea_torque_Nm[0]"}) {
    signals += (signals.empty() ? "" : ",") + std::string(signal);
  }
  // Six of the plots that are there anyway, and these.
  const nlohmann::json figures = Open(address + "?signals=" + signals, "10", "signals.png");
  EXPECT_GE(figures["signals"], kSignals);
  // What the rig's processes miss on a busy machine is not the page's: what is sent is there.
  EXPECT_EQ(figures["client"]["lost"], 0);
  const auto sent = figures["client"]["sent"].get<double>();
  EXPECT_NEAR(figures["received"].get<double>(), sent, kRate_Hz * kTopicsRead);
  EXPECT_GT(figures["samples_per_s"], 0.95 * kSignals * kRate_Hz);
  EXPECT_LT(figures["task_share"], kMostTaskShare);
  EXPECT_GT(figures["draws_per_s"], kLeastDraws_Hz);
  EXPECT_EQ(figures["robot_frames_per_s"], 0.0);
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(30s), 0);
  rig.Signal(SIGINT);
  rig.Wait(30s);
}

TEST(ViewBrowser, TheButtonOfThePageStopsTheRig) {
  SKIP_WITHOUT_PACKAGE(HasBrowser(), "chromium");
  Program rig({kSinew, "launch", kBrowserRobots + "rig/deploy_rig.yaml", "--duration", "0", "--set",
               "domain_id=224"});
  ASSERT_TRUE(rig.WaitForText("surrogate", 60s));
  Program view({kSinew, "view", "--domain", "224", "--port", "0", "--config",
                kBrowserRobots + "rig/view.yaml"});
  const std::string address = AddressIn(&view);
  ASSERT_NE(address, "") << view.error();
  const nlohmann::json moving = Open(address, "11", "rig.png");
  EXPECT_EQ(moving["robot_state"], "armed");
  EXPECT_GT(moving["robot_frames_per_s"], 1.0);
  EXPECT_LT(moving["robot_frames_per_s"], 15.5);
  const nlohmann::json stopped = Open(address, "1", "rig_estopped.png", "estop");
  EXPECT_EQ(stopped["robot_state"], "estopped");
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(30s), 0);
  rig.Signal(SIGINT);
  rig.Wait(30s);
}

TEST(ViewBrowser, ARecordingOfTheBipedIsShown) {
  SKIP_WITHOUT_PACKAGE(HasBrowser(), "chromium");
  const std::string file = SINEW_PICTURES "/biped.mcap";
  std::filesystem::remove(file);
  const Finished recorded =
      sinew::testing::Run({kSinew, "launch", kBrowserRobots + "biped/deploy_biped.yaml",
                           "--duration", "6", "--domain", "224", "--record", file},
                          240s);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.error;
  Program view(
      {kSinew, "view", file, "--port", "0", "--config", kBrowserRobots + "biped/view.yaml"});
  const std::string address = AddressIn(&view);
  ASSERT_NE(address, "") << view.error();
  const nlohmann::json shown = Open(address, "2", "biped.png", "play");
  EXPECT_EQ(shown["robot_state"], "armed");
  EXPECT_GE(shown["participants"], 4) << "world, reference, control, logger";
  ExpectNothingIsCut(address + "?at=5&joint=3&speed=2", "recording");
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(30s), 0);
}

}  // namespace
}  // namespace sinew::testing
