// Frames of body nodes: the small boards of a robot without a gateway that read the four force
// sensors of a foot, or the IMU in the torso. Pure.
//
// Identifiers and heartbeat as those of a sensor node (sensor_node.h). Little-endian.
// sinew_nodes.dbc describes the same bytes for other tools (for node 40).
//
//   0x01 NodeHeartbeat   node -> master, 10 Hz   uptime, error bits, version
//   0x0C FootForces      foot -> master, cyclic  four forces, sequence, a valid bit each
//   0x0D ImuForce        IMU -> master, cyclic   specific force, sequence, valid bits
//   0x0E ImuRate         IMU -> master, cyclic   angular velocity, sequence, temperature
//   0x0F ImuOrientation  IMU -> master, cyclic   quaternion without one component, sequence
//
// A sequence number counts samples, from 0 after 255. The three frames of an IMU that have the same
// one are one sample, measured at one time.
//
// Ranges and steps:
//
//   force             int13, 0.2 N: -819.2 to 819.0 N. The robot weighs 17.1 kg * 9.81 m/s^2 =
//                     168 N: 4.9 times that on one sensor, 19 times on the four of a foot. Half a
//                     step is 0.06 % of the weight; on a foot that carries all of it, errors of
//                     that size at both ends of 0.134 m move the centre of pressure by 0.08 mm.
//   specific force    int16, 0.005 m/s^2: +-163.8 m/s^2 = 16.7 g. An IMU set to +-8 g has a margin
//                     for impacts of the feet; a step is below its noise (BMI088, typical:
//                     175 ug/sqrt(Hz), 0.017 m/s^2 rms in 100 Hz).
//   angular velocity  int16, 0.001 rad/s: +-32.77 rad/s = 1877 deg/s; the noise of the same part
//                     is 0.014 deg/s/sqrt(Hz), 0.0024 rad/s rms in 100 Hz.
//   orientation       int16, 2.2e-5: +-0.7209. Of a unit quaternion the largest component is left
//                     out, so the others are at most sqrt(1/2) = 0.7071. With an error h = 1.1e-5
//                     of each, |dv| <= sqrt(3) h; the one that is left out is r >= 1/2, with
//                     |dr| = |v . dv| / r <= sqrt(3/4) sqrt(3) h / (1/2) = 3 h; the rotation is
//                     wrong by at most 2 sqrt(3 + 9) h = 7.7e-5 rad.
//   temperature       int8, 1 degC: -127 to 127; -128: none.
//
// A value beyond its field is held at the field's end, NaN is sent as 0. What is at an end may be
// anything beyond, and is not to be taken for a measurement (AtFieldEnd). Any thread; allocates
// nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "bridge/can/frame.h"
#include "bridge/can/sensor_node.h"

namespace sinew::can {

// The part of the body that a node measures.
enum class BodyPart { kRightFoot, kLeftFoot, kImu };

const char* BodyPartName(BodyPart part);  // "right foot", "left foot", "imu"

inline constexpr int kFootSensors = 4;

// Normal forces on the sole, positive when it is pressed; two sensors under each of the foot's two
// segments, in the order of the topic foot_force.
struct FootForces {
  std::array<double, kFootSensors> force_N{};
  std::array<bool, kFootSensors> valid{};
  std::uint8_t sequence = 0;
  friend bool operator==(const FootForces&, const FootForces&) = default;
};

// In the frame of the IMU's housing; +9.81 along the axis that points up, at rest.
struct ImuForce {
  std::array<double, 3> specific_force_m_s2{};
  std::uint8_t sequence = 0;
  // Flags of the whole sample.
  bool force_valid = false;
  bool rate_valid = false;
  bool orientation_valid = false;
  friend bool operator==(const ImuForce&, const ImuForce&) = default;
};

// About the axes of the housing.
struct ImuRate {
  std::array<double, 3> angular_velocity_rad_s{};
  std::uint8_t sequence = 0;
  std::optional<int> temperature_degC = {};
  friend bool operator==(const ImuRate&, const ImuRate&) = default;
};

// Housing to world as a unit quaternion without one component, whose sign is positive.
struct ImuOrientation {
  std::array<double, 3> component{};  // the others, in the order w, x, y, z
  std::uint8_t sequence = 0;
  std::uint8_t omitted = 0;  // 0 w, 1 x, 2 y, 3 z
  friend bool operator==(const ImuOrientation&, const ImuOrientation&) = default;
};

Frame Encode(int node, const FootForces& message) noexcept;
Frame Encode(int node, const ImuForce& message) noexcept;
Frame Encode(int node, const ImuRate& message) noexcept;
Frame Encode(int node, const ImuOrientation& message) noexcept;

// Nothing for a frame that is shorter, remote, extended or of another command.
std::optional<FootForces> DecodeFootForces(const Frame& frame) noexcept;
std::optional<ImuForce> DecodeImuForce(const Frame& frame) noexcept;
std::optional<ImuRate> DecodeImuRate(const Frame& frame) noexcept;
std::optional<ImuOrientation> DecodeImuOrientation(const Frame& frame) noexcept;

// The force of this sensor, or one of the three values, is at an end of its field: saturated.
bool AtFieldEnd(const FootForces& message, std::size_t sensor) noexcept;
bool AtFieldEnd(const ImuForce& message) noexcept;
bool AtFieldEnd(const ImuRate& message) noexcept;

// The largest component of w, x, y, z is left out; of either sign, need not be of length 1. Nothing
// for one that is not finite or shorter than 1e-6.
std::optional<ImuOrientation> OmitLargest(const std::array<double, 4>& orientation_wxyz,
                                          std::uint8_t sequence) noexcept;
// w, x, y, z of length 1. Nothing where the squares of the three add up to more than 3/4 and the
// rounding of their fields: the component that was left out was not the largest.
std::optional<std::array<double, 4>> Restore(const ImuOrientation& message) noexcept;

}  // namespace sinew::can
