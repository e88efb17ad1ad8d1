// Where the shapes of a robot are, and where the camera sees them.
#include "sim/render/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/render/camera.h"
#include "sim/render/file/recorded_poses.h"
#include "sim/render/triangles.h"
#include "tests/sim/render/biped_squat.h"

namespace sinew::render {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // sums of a few numbers of size 1

// An arm on the base: turns about y at a height of 0.5 m, then slides along its x.
arm::Chain TurnAndSlide() {
  arm::Body turn, slide;
  turn.link_name = "turned";
  turn.joint_name = "turn";
  turn.moves = true;
  turn.axis = Vector3d::UnitY();
  turn.parent_from_joint.translation().z() = 0.5;
  slide.link_name = "slid";
  slide.joint_name = "slide";
  slide.parent = 0;
  slide.moves = slide.prismatic = true;
  slide.parent_from_joint.translation().x() = 0.1;
  return {"arm", {turn, slide}};
}

TEST(Scene, LinksTurnAndSlideWithTheirJoints) {
  RobotPose pose;
  pose.joint_rad = {std::numbers::pi / 2.0, 0.3};
  pose.world_from_base.translation() = Vector3d(1.0, 2.0, 3.0);
  const auto links = LinkFrames(TurnAndSlide(), pose);
  // Turned by a quarter about y, x points down.
  EXPECT_LT((links[0].translation() - Vector3d(1.0, 2.0, 3.5)).norm(), kExact);
  EXPECT_LT((links[1].translation() - Vector3d(1.0, 2.0, 3.1)).norm(), kExact);
  pose.joint_rad = {0.0};
  EXPECT_THROW(LinkFrames(TurnAndSlide(), pose), std::invalid_argument);
}

TEST(Scene, JointsAreFoundByName) {
  EXPECT_THAT(JointIndices(TurnAndSlide(), {"slide", "turn"}), ::testing::ElementsAre(1u, 0u));
  EXPECT_THROW(JointIndices(TurnAndSlide(), {"knee"}), std::invalid_argument);
}

// Against the corners of the shape's own triangles.
TEST(Scene, NoPointOfAShapeReachesFurtherThanItsReach) {
  const Isometry3d link = Isometry3d(Eigen::Translation3d(0.3, -0.2, 0.7)) *
                          Eigen::AngleAxisd(0.8, Vector3d(1.0, 2.0, -0.5).normalized());
  constexpr double kPolygon = 0.01;  // of the radius; the outline has 48 sides
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    Visual visual;
    visual.shape = shape;
    visual.size_m = shape == Shape::kBox ? Vector3d(0.1, 0.2, 0.3) : Vector3d(0.2, 0.2, 0.4);
    if (shape == Shape::kSphere) visual.size_m.setConstant(0.2);
    visual.link_from_visual.translate(Vector3d(0.0, 0.1, 0.0));
    for (const Vector3d& direction :
         {Vector3d(0.0, 0.0, 1.0), Vector3d(-1.0, 0.0, 0.0), Vector3d(0.6, 0.0, -0.8)}) {
      double furthest = -1e9;
      for (const Vertex& vertex : Triangles(shape)) {
        const Vector3d unit(vertex.position[0], vertex.position[1], vertex.position[2]);
        const Vector3d point = link * visual.link_from_visual * visual.size_m.cwiseProduct(unit);
        furthest = std::max(furthest, direction.dot(point));
      }
      const double reach = Reach(visual, link, direction);
      EXPECT_LE(furthest, reach + 1e-7);
      EXPECT_GE(furthest, reach - kPolygon * visual.size_m.x());
    }
  }
}

TEST(Scene, TrianglesFaceOutwards) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    const std::vector<Vertex> vertices = Triangles(shape);
    ASSERT_EQ(vertices.size() % 3, 0u);
    const auto point = [&](std::size_t i) {
      return Vector3d(vertices[i].position[0], vertices[i].position[1], vertices[i].position[2]);
    };
    double volume = 0.0;
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
      volume += point(i).dot(point(i + 1).cross(point(i + 2))) / 6.0;
    }
    const double full = shape == Shape::kBox        ? 1.0
                        : shape == Shape::kCylinder ? std::numbers::pi
                                                    : 4.0 / 3.0 * std::numbers::pi;
    EXPECT_NEAR(volume, full, 0.02 * full);  // inscribed polygons lose 0.3 to 1.2 %
  }
}

TEST(Scene, TheBipedStandsOnTheGroundAMetreHigh) {
  const Scene scene = BipedSquat().scene();
  const RobotPose pose = StandingPose(scene);
  EXPECT_NEAR(pose.world_from_base.translation().z(), kStandingHeight_m, 1e-9);
  const Eigen::AlignedBox3d box = Extent(scene, pose);
  EXPECT_NEAR(box.min().z(), 0.0, kExact);
  EXPECT_NEAR(box.max().z(), 1.019, 1e-9);
}

// The height that leg kinematics gives from the joints alone is that of the reference.
TEST(Scene, TheSolesStayWhereTheyWereThroughTheSquat) {
  const BipedSquat squat;
  const RobotPose standing = StandingPose(squat.scene());
  for (double time_s = 0.0; time_s <= 5.0; time_s += 0.25) {
    RobotPose pose = squat.JointsAt(time_s);
    PlaceBase(squat.scene(), &pose);
    const double expected_m = standing.world_from_base.translation().z() + squat.Height_m(time_s);
    EXPECT_NEAR(pose.world_from_base.translation().z(), expected_m, 1e-9) << time_s;
    EXPECT_NEAR(pose.world_from_base.translation().head<2>().norm(), 0.0, 1e-9) << time_s;
    EXPECT_NEAR(Extent(squat.scene(), pose).min().z(), 0.0, 1e-9) << time_s;
  }
}

TEST(Camera, ItsTargetIsInTheMiddleAndUpIsUp) {
  Camera camera;
  camera.eye_m = {2.0, 1.0, 1.5};
  camera.target_m = {0.0, 0.0, 0.5};
  const Eigen::Vector2d middle = Project(camera, 640, 480, camera.target_m);
  EXPECT_LT((middle - Eigen::Vector2d(320.0, 240.0)).norm(), 1e-9);
  const Eigen::Vector2d above = Project(camera, 640, 480, camera.target_m + Vector3d(0, 0, 0.1));
  EXPECT_NEAR(above.x(), 320.0, 1e-9);
  EXPECT_LT(above.y(), 240.0);
  // From the front and the left, the robot's left is on the right.
  EXPECT_GT(Project(camera, 640, 480, camera.target_m + Vector3d(0, 0.1, 0)).x(), 320.0);
}

// A pinhole: an object of height h at distance d is h / d / (2 tan(fov / 2)) of the picture high.
TEST(Camera, SizesAreThoseOfAPinhole) {
  Camera camera;
  camera.eye_m = {3.0, 0.0, 0.4};
  camera.target_m = {0.0, 0.0, 0.4};
  camera.field_of_view_rad = 0.6;
  const double low = Project(camera, 640, 480, {0.0, 0.0, 0.3}).y();
  const double high = Project(camera, 640, 480, {0.0, 0.0, 0.5}).y();
  EXPECT_NEAR(low - high, 480.0 * 0.2 / 3.0 / (2.0 * std::tan(0.3)), 1e-9);
}

TEST(Camera, FollowsOnTheGroundButNotUpOrDown) {
  const BipedSquat squat;
  const Camera camera = CameraOf(squat.scene(), View::kThreeQuarter);
  RobotPose pose = squat.At(2.5);
  EXPECT_EQ(Follow(camera, pose).eye_m, camera.eye_m);
  pose.world_from_base.translation().x() += 2.0;
  EXPECT_LT((Follow(camera, pose).target_m - camera.target_m - Vector3d(2.0, 0.0, 0.0)).norm(),
            kExact);
}

TEST(Camera, TheWholeRobotIsInThePicture) {
  const BipedSquat squat;
  for (const Camera& camera :
       {CameraOf(squat.scene(), View::kThreeQuarter), CameraOf(squat.scene(), View::kSide)}) {
    const Eigen::AlignedBox3d box = Extent(squat.scene(), StandingPose(squat.scene()));
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d point = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      const Eigen::Vector2d pixel = Project(camera, 960, 720, point);
      EXPECT_GT(pixel.minCoeff(), 0.0);
      EXPECT_LT(pixel.x(), 960.0);
      EXPECT_LT(pixel.y(), 720.0);
    }
  }
}

}  // namespace
}  // namespace sinew::render
