// Draws a scene: flat ground with a grid, the robot's shapes lit from above, and their shadow on
// the ground. A foot meets its shadow where it touches the ground, and not where it is above it;
// what is below the ground is hidden by it.
//
// Lambert's law with light from one direction and a sky that is brighter above (hemisphere
// lighting), computed in linear light and written as sRGB. The shadow is that of the
// same direction, projected onto z = 0 (Blinn: Me and my (fake) shadow, 1988). Grid: fine lines
// every 0.1 m, strong ones every 0.5 m. Four samples a pixel.
//
// Thread: any, one at a time. Render allocates the picture. Both throw std::runtime_error for what
// OpenGL refuses.
#pragma once

#include <memory>

#include "sim/render/camera.h"
#include "sim/render/image.h"
#include "sim/render/scene.h"

namespace sinew::render {

// Unit vector to the light, world axes: 61 degrees above the horizon, so that a shadow lies close
// to what casts it.
Eigen::Vector3d ToLight();

// Pixels each way; what Mesa's software renderer draws at once is 16384.
inline constexpr int kLargestPicture = 4096;

class Renderer {
 public:
  // Throws std::invalid_argument for a size that is not from 16 to kLargestPicture.
  Renderer(const Scene& scene, int width, int height);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Throws std::invalid_argument: the pose has too few joints.
  Image Render(const RobotPose& pose, const Camera& camera) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::render
