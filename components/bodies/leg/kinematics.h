// Kinematics of a leg of six revolute joints, forward and inverse, both in closed form.
//
// Frames, parallel to each other when every joint is at 0: x forward, y to the left, z up.
//
//     pelvis   --hip_in_pelvis-->  hip centre: yaw about z, then roll about x, then pitch about y
//              --thigh down-->     knee: pitch about y
//              --shank down-->     ankle pitch about y
//              --offset down-->    ankle roll about x (offset: L5 of the source)
//              --sole_in_ankle-->  sole
//
// With B = Rz(yaw) Rx(roll), s = hip pitch + knee + ankle pitch, e = (0, 0, 1):
//
//     R = B Ry(s) Rx(ankle roll)                                                             (1)
//     d = B (-thigh Ry(hip) e - shank Ry(hip + knee) e - offset Ry(s) e)                     (2)
//     p = hip_in_pelvis + d + R sole_in_ankle                                                (3)
//
// Inverse in closed form, although the ankle's axes do not meet: README.md.
//
// The knee bends backwards, as a human's: knee in [0, pi], so the shank turns back from the thigh.
// A positive pitch moves what is below the joint back; both legs have the same axes, so mirroring a
// pose changes the signs of yaw and of both rolls. Inverse(Forward(q)) is q (to multiples of 2 pi)
// where
//
//     knee in [0, pi], |hip roll| < pi / 2 and
//     offset + shank cos(ankle pitch) + thigh cos(knee + ankle pitch) > 0  (hip above the foot) (4)
//
// Source: lengths and order of axes of NU-Biped-4.7, section 3.2.1 and Table 3.1; the derivation is
// our own. SI units. Thread: free functions. Allocates nothing, throws nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sinew::leg {

enum LegJoint { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };
inline constexpr int kLegJoints = 6;

// In the order of LegJoint, rad.
using LegAngles = Eigen::Matrix<double, kLegJoints, 1>;

struct LegGeometry {
  Eigen::Vector3d hip_in_pelvis_m = Eigen::Vector3d::Zero();
  double thigh_m = 0.0;                                       // hip centre to knee
  double shank_m = 0.0;                                       // knee to ankle pitch axis
  double ankle_offset_m = 0.0;                                // ankle pitch axis to ankle roll axis
  Eigen::Vector3d sole_in_ankle_m = Eigen::Vector3d::Zero();  // from the ankle roll axis
};

// Pose of the sole in the pelvis's frame, (1) and (3).
Eigen::Isometry3d Forward(const LegGeometry& geometry, const LegAngles& q) noexcept;

enum class Reach {
  kReached,
  kTooFar,     // the ankle is further from the hip than thigh + shank
  kTooNear,    // nearer than |thigh - shank|
  kUndefined,  // not finite, no rotation, hip on the ankle roll axis, or hip roll of 90 degrees
};

struct LegSolution {
  Reach reach = Reach::kUndefined;
  // Distance of the ankle pitch axis beyond what the leg reaches, m; 0 when reached.
  double miss_m = 0.0;
  // Joint angles; when too far or too near, those of the straight or the folded leg in that
  // direction, with the asked orientation of the sole. Zero when undefined.
  LegAngles q = LegAngles::Zero();

  bool ok() const noexcept { return reach == Reach::kReached; }
};

// The rotation part must be orthonormal to 1e-6, else the pose is kUndefined.
LegSolution Inverse(const LegGeometry& geometry,
                    const Eigen::Isometry3d& pelvis_from_sole) noexcept;

}  // namespace sinew::leg
