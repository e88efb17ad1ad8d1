// Frames of foot and IMU nodes. Expected bytes are written by hand from sinew_nodes.dbc;
// independent_reader_test.cc lets python3-canmatrix read the same file and decode what we encode.
#include "bridge/can/body_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "bridge/can/bit_timing.h"
#include "bridge/can/codec.h"

namespace sinew::can {
namespace {

using BodyBytes = decltype(Frame::data);

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Half a step of each field, and the rounding of doubles.
constexpr double kHalfForce_N = 0.1 + 1e-9;
constexpr double kHalfSpecificForce_m_s2 = 0.0025 + 1e-9;
constexpr double kHalfRate_rad_s = 0.0005 + 1e-9;
constexpr double kWorstRotation_rad = 7.7e-5;  // derived in body_node.h

// Angle of the rotation between two unit quaternions; of small ones exact where acos is not.
double AngleBetween_rad(const std::array<double, 4>& p, const std::array<double, 4>& q) {
  double dot = 0.0;
  for (std::size_t i = 0; i < 4; ++i) dot += p[i] * q[i];
  double square = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double difference = q[i] - (dot < 0.0 ? -p[i] : p[i]);
    square += difference * difference;
  }
  return 4.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(square)));
}

TEST(FootNode, ForcesHaveExactlyTheseBytes) {
  const FootForces m{{0.2, -0.2, 819.0, -819.2}, {true, false, true, true}, 0xA5};
  const Frame frame = Encode(40, m);
  EXPECT_EQ(frame.id, 40U * 32 + 0x0C);
  EXPECT_EQ(frame.length, 8);
  // 1 | 0x1FFF << 13 | 0x0FFF << 26 | 0x1000 << 39 | 0xA5 << 52 | 0b1101 << 60 =
  // 0xDA58003FFFFFE001
  EXPECT_EQ(frame.data, (BodyBytes{0x01, 0xE0, 0xFF, 0xFF, 0x3F, 0x00, 0x58, 0xDA}));
  const auto back = DecodeFootForces(frame);
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(back->force_N[i], m.force_N[i], 1e-9) << i;
  EXPECT_EQ(back->valid, m.valid);
  EXPECT_EQ(back->sequence, 0xA5);
}

TEST(FootNode, NothingIsZeroBytes) {
  EXPECT_EQ(Encode(0, FootForces{}).data, BodyBytes{});
  EXPECT_EQ(DecodeFootForces(Encode(0, FootForces{})), FootForces{});
}

TEST(ImuNode, ForceRateAndOrientationHaveExactlyTheseBytes) {
  // 1962 = 0x07AA; -100 = 0xFF9C; bits 0 and 2
  const Frame force = Encode(42, ImuForce{{0.0, -0.5, 9.81}, 7, true, false, true});
  EXPECT_EQ(force.id, 42U * 32 + 0x0D);
  EXPECT_EQ(force.data, (BodyBytes{0x00, 0x00, 0x9C, 0xFF, 0xAA, 0x07, 0x07, 0x05}));
  // 1000 = 0x03E8; -17453 = 0xBBD3; -5 = 0xFB
  const Frame rate = Encode(42, ImuRate{{1.0, -17.453, 0.0}, 8, -5});
  EXPECT_EQ(rate.id, 42U * 32 + 0x0E);
  EXPECT_EQ(rate.data, (BodyBytes{0xE8, 0x03, 0xD3, 0xBB, 0x00, 0x00, 0x08, 0xFB}));
  EXPECT_EQ(Encode(42, ImuRate{{}, 8, {}}).data[7], 0x80);
  // 0.022 / 2.2e-5 = 1000
  const Frame orientation = Encode(42, ImuOrientation{{0.022, -0.022, 0.0}, 9, 2});
  EXPECT_EQ(orientation.id, 42U * 32 + 0x0F);
  EXPECT_EQ(orientation.data, (BodyBytes{0xE8, 0x03, 0x18, 0xFC, 0x00, 0x00, 0x09, 0x02}));
}

TEST(BodyNode, EveryTruncatedLengthIsRefusedAndSoAreOtherKindsOfFrame) {
  for (int length = 0; length <= 9; ++length) {
    const auto cut = [length](Frame frame) {
      frame.length = static_cast<std::uint8_t>(length);
      return frame;
    };
    EXPECT_EQ(DecodeFootForces(cut(Encode(1, FootForces{}))).has_value(), length == 8);
    EXPECT_EQ(DecodeImuForce(cut(Encode(1, ImuForce{}))).has_value(), length == 8);
    EXPECT_EQ(DecodeImuRate(cut(Encode(1, ImuRate{}))).has_value(), length == 8);
    EXPECT_EQ(DecodeImuOrientation(cut(Encode(1, ImuOrientation{}))).has_value(), length == 8);
  }
  Frame remote = Encode(1, FootForces{});
  remote.remote = true;
  EXPECT_FALSE(DecodeFootForces(remote));
  Frame extended = Encode(1, FootForces{});
  extended.extended = true;
  EXPECT_FALSE(DecodeFootForces(extended));
  EXPECT_FALSE(DecodeFootForces(Encode(1, ImuForce{})));
  EXPECT_FALSE(DecodeImuForce(Encode(1, FootForces{})));
  EXPECT_FALSE(DecodeImuRate(Encode(1, ImuForce{})));
  EXPECT_FALSE(DecodeImuOrientation(Encode(1, ImuRate{})));
}

TEST(BodyNode, ValuesAreHeldAtTheEndsOfTheirFieldAndNanIsZero) {
  const auto foot = DecodeFootForces(Encode(1, FootForces{{1e6, -1e6, kNan, 1e300}, {}, 0}));
  ASSERT_TRUE(foot);
  EXPECT_NEAR(foot->force_N[0], 819.0, 1e-9);
  EXPECT_NEAR(foot->force_N[1], -819.2, 1e-9);
  EXPECT_EQ(foot->force_N[2], 0.0);
  EXPECT_NEAR(foot->force_N[3], 819.0, 1e-9);
  const auto force = DecodeImuForce(Encode(1, ImuForce{{1e6, -1e6, kNan}}));
  EXPECT_NEAR(force->specific_force_m_s2[0], 163.835, 1e-9);
  EXPECT_NEAR(force->specific_force_m_s2[1], -163.84, 1e-9);
  EXPECT_EQ(force->specific_force_m_s2[2], 0.0);
  const auto rate = DecodeImuRate(Encode(1, ImuRate{{1e6, -1e6, kNan}, 0, 1000}));
  EXPECT_NEAR(rate->angular_velocity_rad_s[0], 32.767, 1e-9);
  EXPECT_NEAR(rate->angular_velocity_rad_s[1], -32.768, 1e-9);
  EXPECT_EQ(rate->temperature_degC, 127);
  EXPECT_EQ(DecodeImuRate(Encode(1, ImuRate{{}, 0, -1000}))->temperature_degC, -127);
}

// What the README states of the ranges.
TEST(BodyNode, RangesHoldSeveralTimesTheWeightAndTheImusRange) {
  constexpr double kWeight_N = 17.1 * 9.81;
  EXPECT_GT(DecodeFootForces(Encode(1, FootForces{{1e6, 0, 0, 0}, {}, 0}))->force_N[0],
            4.0 * kWeight_N);
  EXPECT_GT(DecodeImuForce(Encode(1, ImuForce{{1e6, 0, 0}}))->specific_force_m_s2[0], 8.0 * 9.81);
  EXPECT_GT(DecodeImuRate(Encode(1, ImuRate{{1e6, 0, 0}, 0, {}}))->angular_velocity_rad_s[0],
            1000.0 * std::acos(-1.0) / 180.0);
}

TEST(BodyNode, RandomValuesComeBackWithinHalfAStep) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> newton(-819.0, 819.0), specific(-163.0, 163.0),
      rate(-32.0, 32.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10000; ++i) {
    FootForces foot;
    for (double& force_N : foot.force_N) force_N = newton(random);
    foot.sequence = static_cast<std::uint8_t>(i);
    const auto foot_back = DecodeFootForces(Encode(40, foot));
    ImuForce force{{specific(random), specific(random), specific(random)}};
    const auto force_back = DecodeImuForce(Encode(40, force));
    ImuRate turn{{rate(random), rate(random), rate(random)}, 0, {}};
    const auto turn_back = DecodeImuRate(Encode(40, turn));
    ASSERT_TRUE(foot_back && force_back && turn_back);
    EXPECT_EQ(foot_back->sequence, foot.sequence);
    EXPECT_EQ(turn_back->temperature_degC, std::nullopt);
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_NEAR(foot_back->force_N[k], foot.force_N[k], kHalfForce_N);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(force_back->specific_force_m_s2[k], force.specific_force_m_s2[k],
                  kHalfSpecificForce_m_s2);
      ASSERT_NEAR(turn_back->angular_velocity_rad_s[k], turn.angular_velocity_rad_s[k],
                  kHalfRate_rad_s);
    }
    std::array<double, 4> q = {normal(random), normal(random), normal(random), normal(random)};
    const auto sent = OmitLargest(q, 3);
    ASSERT_TRUE(sent);
    const auto received = DecodeImuOrientation(Encode(40, *sent));
    ASSERT_TRUE(received);
    const auto back = Restore(*received);
    ASSERT_TRUE(back);
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& c : q) c /= length;
    ASSERT_LT(AngleBetween_rad(q, *back), kWorstRotation_rad);
  }
}

TEST(ImuOrientation, EachComponentCanBeTheOneThatIsLeftOut) {
  for (std::size_t i = 0; i < 4; ++i) {
    for (const double sign : {1.0, -1.0}) {
      std::array<double, 4> q{};
      q[i] = sign;
      const auto m = OmitLargest(q, 0);
      ASSERT_TRUE(m);
      EXPECT_EQ(m->omitted, i);
      const auto back = Restore(*DecodeImuOrientation(Encode(1, *m)));
      ASSERT_TRUE(back);
      EXPECT_NEAR(AngleBetween_rad(q, *back), 0.0, 1e-12);
      EXPECT_GT((*back)[i], 0.0);
    }
  }
}

// All four of one size: the boundary of what is accepted, with any signs.
TEST(ImuOrientation, FourEqualComponentsAreStillAccepted) {
  for (int signs = 0; signs < 16; ++signs) {
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = (signs >> i & 1) != 0 ? 0.5 : -0.5;
    const auto back = Restore(*DecodeImuOrientation(Encode(1, *OmitLargest(q, 0))));
    ASSERT_TRUE(back) << signs;
    EXPECT_LT(AngleBetween_rad(q, *back), kWorstRotation_rad) << signs;
  }
}

TEST(ImuOrientation, WhatIsNoRotationIsRefused) {
  EXPECT_FALSE(OmitLargest({0.0, 0.0, 0.0, 0.0}, 0));
  EXPECT_FALSE(OmitLargest({kNan, 0.0, 0.0, 1.0}, 0));
  EXPECT_FALSE(OmitLargest({std::numeric_limits<double>::infinity(), 0.0, 0.0, 1.0}, 0));
  EXPECT_FALSE(Restore({{0.7, 0.7, 0.7}, 0, 0}));
  EXPECT_FALSE(Restore({{0.51, 0.51, 0.51}, 0, 3})) << "the smallest was left out";
  EXPECT_FALSE(Restore({{kNan, 0.0, 0.0}, 0, 0}));
  EXPECT_TRUE(Restore({{0.0, 0.0, 0.0}, 0, 0}));
}

TEST(BodyNode, FeetAndImuOnTheBusOfSixAxesFitFiveHundredTimesIntoASecond) {
  const int axes = 6 * (WorstFrameBits(4) + WorstFrameBits(8));
  const int foot = WorstFrameBits(Encode(40, FootForces{}).length);
  const int imu = WorstFrameBits(Encode(42, ImuForce{}).length) +
                  WorstFrameBits(Encode(42, ImuRate{}).length) +
                  WorstFrameBits(Encode(42, ImuOrientation{}).length);
  EXPECT_EQ(axes + foot + imu, 1380 + 135 + 405);
  EXPECT_GE(1e6 / (axes + foot + imu), 500.0);
}

}  // namespace
}  // namespace sinew::can
