// The master's side of the compact exchange: states put together, references that fit.
#include "bridge/joints/compact_link.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::bridge {
namespace {

std::array<can::Frame, can::kCompactStateFrames> State(double turns, std::uint8_t sequence) {
  can::CompactState state;
  state.position_turns.fill(turns);
  state.sequence = sequence;
  return can::EncodeState(5, state);
}

TEST(CompactLink, AStateCountsWhenAllItsFramesCameInTheirOrder) {
  CompactLink link(5);
  const auto first = State(1.0, 1);
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    EXPECT_EQ(link.Take({first[k], 100 + static_cast<std::int64_t>(k)}), CompactLink::Taken::kPart);
    EXPECT_EQ(link.stamp_ns(), 0);
  }
  EXPECT_EQ(link.Take({first.back(), 200}), CompactLink::Taken::kComplete);
  EXPECT_EQ(link.stamp_ns(), 100) << "of the first frame";
  EXPECT_EQ(link.state().position_turns[11], 1.0);
}

TEST(CompactLink, ALostFrameNeverMixesTwoStates) {
  std::mt19937 random(1);
  CompactLink link(5);
  int complete = 0;
  for (int i = 0; i < 2000; ++i) {
    const double turns = 0.01 * (i % 30000);
    for (const can::Frame& frame : State(turns, static_cast<std::uint8_t>(i))) {
      if (random() % 20 == 0) continue;  // lost
      if (link.Take({frame, i + 1}) != CompactLink::Taken::kComplete) continue;
      ++complete;
      EXPECT_EQ(link.stamp_ns(), i + 1);
      for (const double turns_back : link.state().position_turns)
        EXPECT_NEAR(turns_back, turns, 1e-9);
    }
  }
  EXPECT_GT(complete, 500);
  EXPECT_LT(complete, 1500);
}

TEST(CompactLink, OtherFramesAndShortOnesChangeNothing) {
  CompactLink link(5);
  for (const can::Frame& frame : State(1.0, 1)) (void)link.Take({frame, 1});
  can::Frame other = State(2.0, 2)[0];
  other.id = can::Identifier(6, can::StateCommand(0));
  EXPECT_EQ(link.Take({other, 2}), CompactLink::Taken::kNotOurs);
  can::Frame remote = State(2.0, 2)[0];
  remote.remote = true;
  EXPECT_EQ(link.Take({remote, 2}), CompactLink::Taken::kNotOurs);
  auto cut = State(2.0, 2);
  cut[3].length = 7;
  int refused = 0;
  for (const can::Frame& frame : cut) {
    if (link.Take({frame, 2}) == CompactLink::Taken::kRefused) ++refused;
  }
  EXPECT_EQ(refused, 11) << "the short one and all behind it";
  EXPECT_EQ(link.state().position_turns[0], 1.0);
  EXPECT_EQ(link.stamp_ns(), 1);
}

TEST(CompactLink, RefusesAReferenceThatDoesNotFit) {
  CompactLink link(5);
  EXPECT_TRUE(link.SetReference(2, 12.34));
  EXPECT_FALSE(link.SetReference(2, 327.68));
  EXPECT_FALSE(link.SetReference(2, std::nan("")));
  can::CompactReferences back;
  for (const can::Frame& frame : link.References()) {
    EXPECT_TRUE(can::DecodeReferences(5, frame, &back));
  }
  EXPECT_NEAR(back.position_turns[2], 12.34, 1e-9);
}

// Rotation matrices of the three angles, multiplied: another way to the same.
TEST(CompactLink, QuaternionTurnsAsRollThenPitchThenYaw) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-1.5, 1.5);
  for (int i = 0; i < 100; ++i) {
    const double r = angle(random), p = angle(random), y = angle(random);
    const auto [w, qx, qy, qz] = QuaternionOf({r, p, y});
    EXPECT_NEAR(w * w + qx * qx + qy * qy + qz * qz, 1.0, 1e-12);
    // Of the body's x axis, and the z row: -sin p, cos p sin r, cos p cos r.
    EXPECT_NEAR(1.0 - 2.0 * (qy * qy + qz * qz), std::cos(y) * std::cos(p), 1e-12);
    EXPECT_NEAR(2.0 * (qx * qy + w * qz), std::sin(y) * std::cos(p), 1e-12);
    EXPECT_NEAR(2.0 * (qx * qz - w * qy), -std::sin(p), 1e-12);
    EXPECT_NEAR(2.0 * (qy * qz + w * qx), std::cos(p) * std::sin(r), 1e-12);
    EXPECT_NEAR(1.0 - 2.0 * (qx * qx + qy * qy), std::cos(p) * std::cos(r), 1e-12);
  }
}

}  // namespace
}  // namespace sinew::bridge
