#include "sim/render/triangles.h"

#include <cmath>
#include <numbers>

namespace sinew::render {

namespace {

using Eigen::Vector3d;

// The outline of a cylinder of 48 sides differs from a circle by 0.2 % of the radius.
constexpr int kSides = 48;
constexpr int kRings = 24;  // of a sphere, from pole to pole

void AddVertex(const Vector3d& p, const Vector3d& n, std::vector<Vertex>* out) {
  Vertex vertex{};
  for (int axis = 0; axis < 3; ++axis) {
    vertex.position[axis] = static_cast<float>(p[axis]);
    vertex.normal[axis] = static_cast<float>(n[axis]);
  }
  out->push_back(vertex);
}

struct Corner {
  Vector3d position, normal;
};

// a, b, c, d counter-clockwise.
void AddQuad(const Corner& a, const Corner& b, const Corner& c, const Corner& d,
             std::vector<Vertex>* out) {
  for (const Corner* corner : {&a, &b, &c, &a, &c, &d}) {
    AddVertex(corner->position, corner->normal, out);
  }
}

std::vector<Vertex> BoxTriangles() {
  std::vector<Vertex> out;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d n = sign * Vector3d::Unit(axis);
      const Vector3d u = 0.5 * Vector3d::Unit((axis + 1) % 3);
      const Vector3d v = 0.5 * sign * Vector3d::Unit((axis + 2) % 3);  // u x v is along n
      const Vector3d center = 0.5 * n;
      AddQuad({center - u - v, n}, {center + u - v, n}, {center + u + v, n}, {center - u + v, n},
              &out);
    }
  }
  return out;
}

Vector3d OnCircle(int side) {
  const double angle_rad = 2.0 * std::numbers::pi * side / kSides;
  return {std::cos(angle_rad), std::sin(angle_rad), 0.0};
}

std::vector<Vertex> CylinderTriangles() {
  std::vector<Vertex> out;
  const Vector3d up = Vector3d::UnitZ();
  for (int side = 0; side < kSides; ++side) {
    const Vector3d a = OnCircle(side), b = OnCircle(side + 1);
    AddQuad({a - 0.5 * up, a}, {b - 0.5 * up, b}, {b + 0.5 * up, b}, {a + 0.5 * up, a}, &out);
    for (const Vector3d& p : {Vector3d(0.5 * up), Vector3d(a + 0.5 * up), Vector3d(b + 0.5 * up)}) {
      AddVertex(p, up, &out);
    }
    for (const Vector3d& p :
         {Vector3d(-0.5 * up), Vector3d(b - 0.5 * up), Vector3d(a - 0.5 * up)}) {
      AddVertex(p, -up, &out);
    }
  }
  return out;
}

Vector3d OnSphere(int ring, int side) {
  const double polar_rad = std::numbers::pi * ring / kRings;
  return std::sin(polar_rad) * OnCircle(side) + std::cos(polar_rad) * Vector3d::UnitZ();
}

std::vector<Vertex> SphereTriangles() {
  std::vector<Vertex> out;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const Vector3d a = OnSphere(ring + 1, side), b = OnSphere(ring + 1, side + 1);
      const Vector3d c = OnSphere(ring, side + 1), d = OnSphere(ring, side);
      AddQuad({a, a}, {b, b}, {c, c}, {d, d}, &out);
    }
  }
  return out;
}

}  // namespace

std::vector<Vertex> Triangles(Shape shape) {
  switch (shape) {
    case Shape::kBox:
      return BoxTriangles();
    case Shape::kCylinder:
      return CylinderTriangles();
    case Shape::kSphere:
      break;
  }
  return SphereTriangles();
}

}  // namespace sinew::render
