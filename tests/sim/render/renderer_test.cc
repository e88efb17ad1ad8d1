// Pictures of the biped in its squat: where its pixels are, and that they are the same each time.
#include "sim/render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "tests/sim/render/biped_squat.h"

namespace sinew::render {
namespace {

constexpr int kWidth = 480, kHeight = 360;

// A pixel of a colour that ground, background and shadow do not have: red and blue differ.
bool IsLeg(std::span<const std::uint8_t, kBytesOfPixel> rgb) {
  return std::abs(static_cast<int>(rgb[0]) - static_cast<int>(rgb[2])) > 60;
}

struct Rows {
  int first = -1, last = -1;
};

template <typename Predicate>
Rows RowsWith(const Image& image, const Predicate& holds) {
  Rows rows;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!holds(image.At(x, y))) continue;
      if (rows.first < 0) rows.first = y;
      rows.last = y;
      break;
    }
  }
  return rows;
}

// The robot differs from a picture in which it is far below the ground.
Rows RobotRows(const Renderer& renderer, const RobotPose& pose, const Camera& camera) {
  RobotPose buried = pose;
  buried.world_from_base.translation().z() -= 10.0;
  const Image with = renderer.Render(pose, camera), without = renderer.Render(buried, camera);
  Rows rows;
  for (int y = 0; y < with.height; ++y) {
    for (int x = 0; x < with.width; ++x) {
      const auto a = with.At(x, y), b = without.At(x, y);
      int difference = 0;
      for (std::size_t i = 0; i < kBytesOfPixel; ++i) difference += std::abs(a[i] - b[i]);
      if (difference < 30) continue;
      if (rows.first < 0) rows.first = y;
      rows.last = y;
      break;
    }
  }
  return rows;
}

TEST(Renderer, TheRobotMovesDownByTheDepthOfTheSquat) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kSide);
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  const RobotPose top = squat.At(0.0), bottom = squat.At(2.5);
  const Rows high = RobotRows(renderer, top, camera), low = RobotRows(renderer, bottom, camera);
  // Of the highest corner of the torso in the picture.
  const auto row_of = [&](const RobotPose& pose) {
    double row = kHeight;
    for (const double x_m : {-0.07, 0.07}) {
      for (const double y_m : {-0.11, 0.11}) {
        const Eigen::Vector3d corner =
            pose.world_from_base.translation() + Eigen::Vector3d(x_m, y_m, 0.243);
        row = std::min(row, Project(camera, kWidth, kHeight, corner).y());
      }
    }
    return row;
  };
  constexpr double kPixels = 1.5;  // a row that is covered in part may differ too little
  EXPECT_NEAR(high.first, row_of(top), kPixels);
  EXPECT_NEAR(low.first, row_of(bottom), kPixels);
  const double moved = row_of(bottom) - row_of(top);
  EXPECT_GT(moved, 0.25 * kHeight);  // 0.38 m of a robot of 1 m
  EXPECT_NEAR(low.first - high.first, moved, kPixels);
  // The feet stay.
  EXPECT_NEAR(low.last, high.last, kPixels);
}

TEST(Renderer, TheSolesAreDrawnOnTheGround) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kSide);
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  const Rows rows = RobotRows(renderer, squat.At(1.0), camera);
  // The nearest lower edge of the robot: the left foot's outer side.
  const double sole = Project(camera, kWidth, kHeight, {0.0, 0.075 + 0.045, 0.0}).y();
  EXPECT_NEAR(rows.last, sole, 3.0);
}

TEST(Renderer, TheGroundHidesWhatIsBelowIt) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kThreeQuarter);
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  RobotPose pose = squat.At(0.0);
  EXPECT_GT(RowsWith(renderer.Render(pose, camera), IsLeg).last, 0);
  pose.world_from_base.translation().z() -= 10.0;
  EXPECT_EQ(RowsWith(renderer.Render(pose, camera), IsLeg).last, -1);
}

TEST(Renderer, AFootAboveTheGroundLeavesItsShadow) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kSide);
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  RobotPose pose = squat.At(0.0);
  const auto ground_below_the_foot = [&] {
    // Seen between the ground and a foot that is 0.1 m above it; away from the grid's lines.
    const Eigen::Vector2d at = Project(camera, kWidth, kHeight, {-0.03, 0.03, 0.0});
    const Image image = renderer.Render(pose, camera);
    return image.At(static_cast<int>(at.x()), static_cast<int>(at.y()))[1];
  };
  pose.world_from_base.translation().z() += 0.1;
  const int shaded = ground_below_the_foot();
  pose.world_from_base.translation().z() += 5.0;
  pose.world_from_base.translation().y() += 5.0;
  const int lit = ground_below_the_foot();
  EXPECT_LT(shaded, lit - 40);
}

TEST(Renderer, LeftIsBlueAndRightIsOrange) {
  const BipedSquat squat;
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  Camera front = CameraOf(squat.scene(), View::kSide);
  front.eye_m = front.target_m + Eigen::Vector3d((front.eye_m - front.target_m).norm(), 0.0, 0.0);
  const Image image = renderer.Render(squat.At(0.0), front);
  int blue = 0, orange = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto rgb = image.At(x, y);
      if (!IsLeg(rgb)) continue;
      // Seen from the front, its left is on the right.
      const bool is_left = x > kWidth / 2;
      EXPECT_EQ(rgb[2] > rgb[0], is_left) << x << ' ' << y;
      ++(is_left ? blue : orange);
    }
  }
  EXPECT_GT(blue, 500);
  EXPECT_NEAR(blue, orange, 0.1 * blue);
}

TEST(Renderer, TheSamePoseGivesTheSamePicture) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kThreeQuarter);
  const Renderer first(squat.scene(), kWidth, kHeight), second(squat.scene(), kWidth, kHeight);
  const Image a = first.Render(squat.At(1.3), camera);
  (void)first.Render(squat.At(2.0), camera);
  const Image b = first.Render(squat.At(1.3), camera), c = second.Render(squat.At(1.3), camera);
  EXPECT_TRUE(a.rgb == b.rgb);
  EXPECT_TRUE(a.rgb == c.rgb);
  EXPECT_FALSE(a.rgb == first.Render(squat.At(2.0), camera).rgb);
}

TEST(Renderer, RefusesSizesAndPosesThatItCannotDraw) {
  const BipedSquat squat;
  EXPECT_THROW(Renderer(squat.scene(), 0, 480), std::invalid_argument);
  EXPECT_THROW(Renderer(squat.scene(), 640, kLargestPicture + 1), std::invalid_argument);
  const Renderer renderer(squat.scene(), kWidth, kHeight);
  EXPECT_THROW((void)renderer.Render(RobotPose{}, Camera{}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::render
