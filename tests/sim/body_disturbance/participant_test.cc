// The program sinew-body-disturbance with a state provider in lockstep whose plant only notes what
// acts on it. Domains 178, 179.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "components/robot/provider/participant/run_provider.h"
#include "components/robot/provider/simulated_plant.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::body_disturbance {
namespace {

using namespace std::chrono_literals;
using provider::BodyDisturbance;

constexpr int kNotedDomain = 178;

// A disturbance that is another one than before, and the step of the plant in which it acts first.
struct Noted {
  std::uint64_t step = 0;
  BodyDisturbance disturbance;
  bool operator==(const Noted&) const = default;
};

class NotingPlant final : public provider::SimulatedPlant {
 public:
  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(provider::PlantSensors*) override {}
  void Step(const provider::PlantCommand&, double, provider::PlantSensors*) override { ++steps_; }
  void Disturb(const provider::Disturbance&) override {}
  void ImposePressure(const provider::ImposedPressure&) override {}
  const provider::GearTruth& gear_truth() const override { return gears_; }
  void DisturbBody(const BodyDisturbance& disturbance) override {
    if (disturbance == acting_) return;
    acting_ = disturbance;
    noted.push_back({steps_, disturbance});
  }
  bool HasDrive(const std::string& joint) const override { return joint == "knee"; }
  const provider::BodyTruth* body_truth() const override { return &body_; }

  std::vector<Noted> noted;

 private:
  std::uint64_t steps_ = 0;
  BodyDisturbance acting_;
  provider::GearTruth gears_;
  provider::BodyTruth body_;
};

constexpr const char* kLoads =
    "schema: sinew-body-disturbance/1\n"
    "disturbances:\n"
    "  - {at_s: 1, for_s: 0.5, payload: {link: torso, mass_kg: 4, place_m: [0.1, 0, 0.2]}}\n"
    "  - {at_s: 1.25, for_s: 0.05, push: {link: pelvis, force_N: [60, 0, 0], place_m: [0, 0, "
    "0]}}\n"
    "  - {at_s: 1.6, for_s: 0.1, lost_drive: knee, lost_friction: 0.9}\n";

std::vector<Noted> Session(const std::string& config) {
  NotingPlant plant;
  node::Options options;
  options.component = options.name = "provider";
  options.domain_id = kNotedDomain;
  options.mode = node::TimeMode::kLockstep;
  node::StopFlag stop;
  testing::Program program({SINEW_BIN_DIR "/sinew-body-disturbance", "--domain",
                            std::to_string(kNotedDomain), "--lockstep", "--config", config});
  provider::ProviderOptions run;
  run.duration_s = 2.0;
  run.arm = true;
  run.await = {"sim_body_disturbance"};
  provider::RunProvider(options, stop, run, {}, plant);
  EXPECT_EQ(program.Wait(20s), 0) << program.error();
  return plant.noted;
}

TEST(SinewBodyDisturbance, ActsFromTheTickThatTheFileSaysInEverySession) {
  const testing::TemporaryFolder folder;
  const std::string config = folder.Write("loads.yaml", kLoads);
  const BodyDisturbance load{.payload_link = "torso",
                             .payload_kg = 4.0,
                             .payload_m = {0.1, 0.0, 0.2},
                             .push_link = "",
                             .push_force_N = {},
                             .push_m = {},
                             .lost_drive = "",
                             .lost_friction = 0.0};
  BodyDisturbance both = load;
  both.push_link = "pelvis";
  both.push_force_N = {60.0, 0.0, 0.0};
  BodyDisturbance lost;
  lost.lost_drive = "knee";
  lost.lost_friction = 0.9;
  const std::vector<Noted> expected = {{240, load}, {300, both}, {312, load},
                                       {360, {}},   {384, lost}, {408, {}}};
  EXPECT_EQ(Session(config), expected);
  EXPECT_EQ(Session(config), expected);
}

TEST(SinewBodyDisturbance, WithoutAFileItEndsWithTwo) {
  const testing::Finished run =
      testing::Run({SINEW_BIN_DIR "/sinew-body-disturbance", "--domain", "179"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error + run.output, ::testing::HasSubstr("--config"));
}

}  // namespace
}  // namespace sinew::body_disturbance
