// A film of a simulation that runs: frames at their times, without work in the loop.
#include "sim/render/participant/live_film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "sim/render/participant/plant_film.h"
#include "tests/sim/render/biped_squat.h"
#include "tests/support/allocations.h"
#include "tests/support/temporary_folder.h"

namespace sinew::render {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double kPeriod_s = 1.0 / 240.0;

LiveFilmOptions SmallLiveFilm(const fs::path& folder) {
  LiveFilmOptions options;
  options.film.frames = folder;
  options.film.width = 64;
  options.film.height = 64;
  options.joint_names = {"left_knee", "right_knee"};
  options.waits = true;
  return options;
}

TEST(LiveFilm, DrawsAFrameForEachPeriodOfTheFilm) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  LiveFilm live(squat.scene(), SmallLiveFilm(folder.path()));
  std::vector<double> read_at;
  for (int tick = 0; tick <= 240; ++tick) {  // 1 s
    const double time_s = tick * kPeriod_s;
    live.Offer(time_s, [&](RobotPose* pose) {
      read_at.push_back(time_s);
      ASSERT_EQ(pose->joint_rad.size(), 2u);
      pose->joint_rad = {0.1, 0.2};
      pose->world_from_base = squat.At(time_s).world_from_base;
    });
  }
  live.Finish();
  ASSERT_EQ(read_at.size(), 26u);
  for (std::size_t i = 0; i < read_at.size(); ++i) {
    EXPECT_GE(read_at[i], 0.04 * static_cast<double>(i) - 1e-6);
    EXPECT_LT(read_at[i], 0.04 * static_cast<double>(i) + kPeriod_s);
  }
  EXPECT_EQ(live.drawn(), 26u);
  EXPECT_EQ(live.left_out(), 0u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 26);
}

// More frames than the queue holds, offered at once: in lockstep all are drawn.
TEST(LiveFilm, WaitsInLockstepAndLeavesOutOtherwise) {
  constexpr std::size_t kQueued = 5, kOffered = 40;
  for (const bool waits : {true, false}) {
    const testing::TemporaryFolder folder;
    const BipedSquat squat;
    LiveFilmOptions options = SmallLiveFilm(folder.path());
    options.waits = waits;
    options.queued_frames = kQueued;
    LiveFilm live(squat.scene(), options);
    for (std::size_t i = 0; i < kOffered; ++i) {
      live.Offer(0.04 * static_cast<double>(i), [](RobotPose*) {});
    }
    live.Finish();
    EXPECT_EQ(live.drawn() + live.left_out(), kOffered);
    EXPECT_TRUE(!waits || live.left_out() == 0u) << live.left_out();
    EXPECT_GE(live.drawn(), kQueued);
  }
}

TEST(LiveFilm, RefusesAtOnceWhatItCannotDraw) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  LiveFilmOptions options = SmallLiveFilm(folder.path());
  options.joint_names = {"third_knee"};
  EXPECT_THROW(LiveFilm(squat.scene(), options), std::invalid_argument);
  options = SmallLiveFilm(folder.path());
  options.film.video = "/no/such/folder/a.mp4";
  EXPECT_THROW(LiveFilm(squat.scene(), options), UsageError);
}

TEST(LiveFilm, WithoutAnEndThereIsNoVideo) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  LiveFilmOptions options = SmallLiveFilm("");
  options.film.video = folder.path() / "a.mp4";
  {
    LiveFilm live(squat.scene(), options);
    live.Offer(0.0, [](RobotPose*) {});
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  LiveFilm live(squat.scene(), options);
  live.Offer(0.0, [](RobotPose*) {});
  live.Finish();
  EXPECT_TRUE(fs::exists(options.film.video));
}

// Of a provider's plant: base by body_truth, joints by their sensors.
class StandingPlant final : public provider::SimulatedPlant {
 public:
  int joint_count() const override { return 2; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(provider::PlantSensors*) override {}
  void Step(const provider::PlantCommand&, double, provider::PlantSensors*) override {}
  void Disturb(const provider::Disturbance&) override {}
  void ImposePressure(const provider::ImposedPressure&) override {}
  const provider::GearTruth& gear_truth() const override { return gears_; }
  const provider::BodyTruth* body_truth() const override { return &truth_; }

 private:
  provider::GearTruth gears_;
  provider::BodyTruth truth_{.position_m = {0.0, 0.0, kStandingHeight_m}};
};

TEST(PlantFilm, ObservesAPlantWithoutAllocating) {
  const testing::TemporaryFolder folder;
  const StandingPlant plant;
  const fs::path video = folder.path() / "plant.mp4";
  PlantFilm film(plant, {"left_knee", "right_knee"}, BipedSquat::Folder() + "biped.urdf", video,
                 false);
  const auto observe = film.Observer();
  provider::PlantSensors sensors;
  sensors.position_rad[0] = 0.5;
  observe(0.0, sensors);
  film.Finish();
  // The thread that draws has ended: what is counted is the loop's.
  const long before = test::Allocations();
  for (int tick = 1; tick < 240; ++tick) observe(tick * kPeriod_s, sensors);
  EXPECT_EQ(test::Allocations(), before);
  EXPECT_GT(fs::file_size(video), 1000u);
}

}  // namespace
}  // namespace sinew::render
