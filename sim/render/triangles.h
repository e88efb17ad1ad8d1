// The shapes of a scene as triangles, of unit size: a Visual's size_m scales them.
#pragma once

#include <vector>

#include "sim/render/scene.h"

namespace sinew::render {

struct Vertex {
  float position[3];
  float normal[3];
};

// Three vertices a triangle, counter-clockwise seen from outside. Box: edges of 1. Cylinder: radius
// 1, length 1 along z. Sphere: radius 1. All about the origin.
std::vector<Vertex> Triangles(Shape shape);

}  // namespace sinew::render
