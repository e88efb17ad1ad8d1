#include "bridge/can/body_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bridge/can/bytes.h"
#include "bridge/can/node_frame.h"

namespace sinew::can {
namespace {

constexpr double kFootForceStep_N = 0.2;
constexpr double kSpecificForceStep_m_s2 = 0.005;
constexpr double kRateStep_rad_s = 0.001;
constexpr double kQuaternionStep = 2.2e-5;
constexpr int kNoTemperature = -128;

// Foot forces share eight bytes: 13 bits each, then the sequence number, then the valid bits.
constexpr int kForceBits = 13;
constexpr int kFootSequenceBit = kFootSensors * kForceBits;
constexpr int kFootValidBit = kFootSequenceBit + 8;
constexpr int kForceMax = (1 << (kForceBits - 1)) - 1;
constexpr int kForceMin = -kForceMax - 1;

// The three that are sent have at most 3/4 of the square of the length. Rounding each by half a
// step h adds at most 2 sqrt(3/4) sqrt(3) h + 3 h^2 = 3 h + 4e-10.
constexpr double kMostSquare = 0.75 + 3.0 * 0.5 * kQuaternionStep + 1e-9;

void PutThree(Frame& frame, const std::array<double, 3>& values, double step) {
  for (int i = 0; i < 3; ++i) {
    PutInteger(frame, 2 * i, Quantise<std::int16_t>(values[static_cast<std::size_t>(i)], step));
  }
}

std::array<double, 3> GetThree(const Frame& frame, double step) {
  std::array<double, 3> values;
  for (int i = 0; i < 3; ++i) {
    values[static_cast<std::size_t>(i)] = step * GetInteger<std::int16_t>(frame, 2 * i);
  }
  return values;
}

// At an end of int16, as decoded or before it was encoded.
bool AnyAtEnd(const std::array<double, 3>& values, double step) {
  return std::any_of(values.begin(), values.end(), [step](double value) {
    const auto field = Quantise<std::int16_t>(value, step);
    return field == std::numeric_limits<std::int16_t>::min() ||
           field == std::numeric_limits<std::int16_t>::max();
  });
}

}  // namespace

const char* BodyPartName(BodyPart part) {
  switch (part) {
    case BodyPart::kRightFoot:
      return "right foot";
    case BodyPart::kLeftFoot:
      return "left foot";
    case BodyPart::kImu:
      break;
  }
  return "imu";
}

Frame Encode(int node, const FootForces& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kFootForces, 8);
  std::uint64_t bits = static_cast<std::uint64_t>(m.sequence) << kFootSequenceBit;
  for (std::size_t i = 0; i < kFootSensors; ++i) {
    const int steps = std::clamp<int>(Quantise<std::int16_t>(m.force_N[i], kFootForceStep_N),
                                      kForceMin, kForceMax);
    const auto field = static_cast<std::uint64_t>(steps) & ((1U << kForceBits) - 1U);
    bits |= field << (kForceBits * static_cast<int>(i));
    bits |= static_cast<std::uint64_t>(m.valid[i] ? 1 : 0) << (kFootValidBit + static_cast<int>(i));
  }
  PutInteger(frame, 0, bits);
  return frame;
}

std::optional<FootForces> DecodeFootForces(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kFootForces, 8)) return std::nullopt;
  const auto bits = GetInteger<std::uint64_t>(frame, 0);
  FootForces m;
  for (std::size_t i = 0; i < kFootSensors; ++i) {
    auto steps =
        static_cast<int>(bits >> (kForceBits * static_cast<int>(i)) & ((1U << kForceBits) - 1U));
    if (steps > kForceMax) steps -= 1 << kForceBits;
    m.force_N[i] = kFootForceStep_N * steps;
    m.valid[i] = (bits >> (kFootValidBit + static_cast<int>(i)) & 1U) != 0;
  }
  m.sequence = static_cast<std::uint8_t>(bits >> kFootSequenceBit);
  return m;
}

Frame Encode(int node, const ImuForce& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kImuForce, 8);
  PutThree(frame, m.specific_force_m_s2, kSpecificForceStep_m_s2);
  frame.data[6] = m.sequence;
  frame.data[7] = static_cast<std::uint8_t>(Bit(m.force_valid, 0) | Bit(m.rate_valid, 1) |
                                            Bit(m.orientation_valid, 2));
  return frame;
}

std::optional<ImuForce> DecodeImuForce(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kImuForce, 8)) return std::nullopt;
  return ImuForce{GetThree(frame, kSpecificForceStep_m_s2), frame.data[6], Bit(frame.data[7], 0),
                  Bit(frame.data[7], 1), Bit(frame.data[7], 2)};
}

Frame Encode(int node, const ImuRate& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kImuRate, 8);
  PutThree(frame, m.angular_velocity_rad_s, kRateStep_rad_s);
  frame.data[6] = m.sequence;
  const int temperature =
      m.temperature_degC ? std::clamp(*m.temperature_degC, -127, 127) : kNoTemperature;
  PutInteger(frame, 7, static_cast<std::int8_t>(temperature));
  return frame;
}

std::optional<ImuRate> DecodeImuRate(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kImuRate, 8)) return std::nullopt;
  ImuRate m{GetThree(frame, kRateStep_rad_s), frame.data[6]};
  const int byte = frame.data[7];
  const int temperature = byte < 128 ? byte : byte - 256;
  if (temperature != kNoTemperature) m.temperature_degC = temperature;
  return m;
}

Frame Encode(int node, const ImuOrientation& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kImuOrientation, 8);
  PutThree(frame, m.component, kQuaternionStep);
  frame.data[6] = m.sequence;
  frame.data[7] = m.omitted & 3U;
  return frame;
}

std::optional<ImuOrientation> DecodeImuOrientation(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kImuOrientation, 8)) return std::nullopt;
  return ImuOrientation{GetThree(frame, kQuaternionStep), frame.data[6],
                        static_cast<std::uint8_t>(frame.data[7] & 3U)};
}

bool AtFieldEnd(const FootForces& message, std::size_t sensor) noexcept {
  const int steps = Quantise<std::int16_t>(message.force_N[sensor], kFootForceStep_N);
  return steps <= kForceMin || steps >= kForceMax;
}

bool AtFieldEnd(const ImuForce& message) noexcept {
  return AnyAtEnd(message.specific_force_m_s2, kSpecificForceStep_m_s2);
}

bool AtFieldEnd(const ImuRate& message) noexcept {
  return AnyAtEnd(message.angular_velocity_rad_s, kRateStep_rad_s);
}

std::optional<ImuOrientation> OmitLargest(const std::array<double, 4>& orientation_wxyz,
                                          std::uint8_t sequence) noexcept {
  double square = 0.0;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    square += orientation_wxyz[i] * orientation_wxyz[i];
    if (std::abs(orientation_wxyz[i]) > std::abs(orientation_wxyz[largest])) largest = i;
  }
  const double length = std::sqrt(square);
  if (!std::isfinite(length) || length < 1e-6) return std::nullopt;
  // q and -q are the same rotation.
  const double scale = (orientation_wxyz[largest] < 0.0 ? -1.0 : 1.0) / length;
  ImuOrientation m;
  m.sequence = sequence;
  m.omitted = static_cast<std::uint8_t>(largest);
  for (std::size_t i = 0, k = 0; i < 4; ++i) {
    if (i != largest) m.component[k++] = scale * orientation_wxyz[i];
  }
  return m;
}

std::optional<std::array<double, 4>> Restore(const ImuOrientation& message) noexcept {
  double square = 0.0;
  for (const double c : message.component) square += c * c;
  if (!(square <= kMostSquare)) return std::nullopt;
  std::array<double, 4> q{};
  const std::size_t omitted = message.omitted & 3U;
  for (std::size_t i = 0, k = 0; i < 4; ++i) {
    q[i] = i == omitted ? std::sqrt(1.0 - square) : message.component[k++];
  }
  return q;
}

}  // namespace sinew::can
