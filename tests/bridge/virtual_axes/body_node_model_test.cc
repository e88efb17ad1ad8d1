// Foot and IMU nodes alone: the plant's sensors in, frames out.
#include "bridge/virtual_axes/body_node_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace sinew::virtual_axes {
namespace {

class BodyNode : public ::testing::Test {
 protected:
  BodyNode() {
    for (std::size_t i = 0; i < 8; ++i) body.foot_force_N[i] = 10.0 * static_cast<double>(i);
    body.foot_valid.fill(true);
    body.foot_valid[6] = false;
    body.acceleration_m_s2 = {1.0, 2.0, 9.81};
    body.angular_velocity_rad_s = {0.1, 0.2, 0.3};
    body.imu_valid = true;
  }
  static BodyNodeConfig Config(can::BodyPart part) {
    BodyNodeConfig config;
    config.node = 40;
    config.part = part;
    return config;
  }
  std::vector<can::Frame> DueOf(BodyNodeModel& node, int ms) {
    const auto due = node.Due(&body, ms * kMs_ns);
    return {due.begin(), due.end()};
  }

  provider::BodySensors body;
};

TEST_F(BodyNode, AFootSendsItsFourSensorsAtItsPeriodAndAHeartbeatAtTenHertz) {
  BodyNodeModel node(Config(can::BodyPart::kLeftFoot));
  node.Start(0, 0);
  int samples = 0, heartbeats = 0;
  for (int ms = 0; ms < 1000; ++ms) {
    for (const can::Frame& frame : DueOf(node, ms)) {
      if (const auto heartbeat = can::DecodeNodeHeartbeat(frame)) {
        ++heartbeats;
        EXPECT_EQ(heartbeat->uptime_ms, static_cast<std::uint32_t>(ms));
        EXPECT_EQ(heartbeat->version, can::kNodeFramesVersion);
        continue;
      }
      const auto foot = can::DecodeFootForces(frame);
      ASSERT_TRUE(foot);
      ++samples;
      EXPECT_EQ(foot->sequence, static_cast<std::uint8_t>(samples));
      EXPECT_NEAR(foot->force_N[0], 40.0, 1e-9);
      EXPECT_NEAR(foot->force_N[3], 70.0, 1e-9);
      EXPECT_EQ(foot->valid, (std::array<bool, 4>{true, true, false, true}));
    }
  }
  EXPECT_EQ(samples, 500);
  EXPECT_EQ(heartbeats, 10);
}

// Against the law of the mean and of the variance, within four of their own deviations.
TEST_F(BodyNode, AnImuHasTheNoiseOfItsConfigurationAndNodesOfOneSeedHaveTheirOwn) {
  BodyNodeConfig config = Config(can::BodyPart::kImu);
  config.force_noise_m_s2 = 0.05;
  config.rate_noise_rad_s = 0.01;
  BodyNodeModel node(config, 3), again(config, 3), other(config, 4);
  BodyNodeConfig of_other_number = config;
  of_other_number.node = 41;
  BodyNodeModel neighbour(of_other_number, 3);
  for (BodyNodeModel* n : {&node, &again, &other, &neighbour}) n->Start(0, 0);
  constexpr int kSamples = 2000;
  double sum = 0.0, squares = 0.0, rate_squares = 0.0;
  int same_other = 0, same_neighbour = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto force = [&](BodyNodeModel& n, double* rate_rad_s = nullptr) {
      double x_m_s2 = NAN;
      for (const can::Frame& frame : DueOf(n, 2 * i)) {
        if (const auto f = can::DecodeImuForce(frame)) x_m_s2 = f->specific_force_m_s2[0];
        const auto rate = can::DecodeImuRate(frame);
        if (rate && rate_rad_s != nullptr) *rate_rad_s = rate->angular_velocity_rad_s[2];
      }
      return x_m_s2;
    };
    double rate_rad_s = 0.0;
    const double x_m_s2 = force(node, &rate_rad_s);
    ASSERT_EQ(force(again), x_m_s2) << i;
    same_other += force(other) == x_m_s2 ? 1 : 0;
    same_neighbour += force(neighbour) == x_m_s2 ? 1 : 0;
    sum += x_m_s2 - 1.0;
    squares += (x_m_s2 - 1.0) * (x_m_s2 - 1.0);
    rate_squares += (rate_rad_s - 0.3) * (rate_rad_s - 0.3);
  }
  const double of_variance = 4.0 * std::sqrt(2.0 / kSamples);
  EXPECT_NEAR(sum / kSamples, 0.0, 4.0 * 0.05 / std::sqrt(kSamples));
  EXPECT_NEAR(squares / kSamples / (0.05 * 0.05), 1.0, of_variance);
  EXPECT_NEAR(rate_squares / kSamples / (0.01 * 0.01), 1.0, of_variance);
  // Steps of 0.005: two that are independent agree with 0.005 / (2 sqrt(pi) 0.05) = 0.028.
  EXPECT_LT(same_other, kSamples / 20);
  EXPECT_LT(same_neighbour, kSamples / 20);
}

// Turned by 90 degrees about z, in a level torso.
TEST_F(BodyNode, AnImuMeasuresInItsHousing) {
  BodyNodeConfig config = Config(can::BodyPart::kImu);
  config.mounting_rpy_rad = {0.0, 0.0, std::acos(0.0)};
  BodyNodeModel node(config);
  node.Start(0, 0);
  const auto frames = DueOf(node, 0);
  ASSERT_EQ(frames.size(), 4U);
  const auto force = can::DecodeImuForce(frames[1]);
  const auto rate = can::DecodeImuRate(frames[2]);
  const auto orientation = can::DecodeImuOrientation(frames[3]);
  ASSERT_TRUE(force && rate && orientation);
  EXPECT_NEAR(force->specific_force_m_s2[0], 2.0, 0.0026);
  EXPECT_NEAR(force->specific_force_m_s2[1], -1.0, 0.0026);
  EXPECT_NEAR(force->specific_force_m_s2[2], 9.81, 0.0026);
  EXPECT_NEAR(rate->angular_velocity_rad_s[0], 0.2, 0.00051);
  EXPECT_NEAR(rate->angular_velocity_rad_s[1], -0.1, 0.00051);
  EXPECT_TRUE(force->force_valid && force->rate_valid && force->orientation_valid);
  EXPECT_EQ(force->sequence, rate->sequence);
  EXPECT_EQ(force->sequence, orientation->sequence);
  const auto q = can::Restore(*orientation);
  ASSERT_TRUE(q);
  EXPECT_NEAR((*q)[0], std::sqrt(0.5), 4e-5);
  EXPECT_NEAR((*q)[3], std::sqrt(0.5), 4e-5);
}

TEST_F(BodyNode, AFrozenOneRepeatsItsLastSample) {
  BodyNodeConfig config = Config(can::BodyPart::kRightFoot);
  config.fault = {BodyFaultKind::kFrozen, 0.010};
  BodyNodeModel node(config);
  node.Start(0, 0);
  for (int ms = 0; ms < 10; ms += 2) (void)DueOf(node, ms);
  body.foot_force_N[0] = 333.0;
  for (int ms = 10; ms < 30; ms += 2) {
    const auto foot = can::DecodeFootForces(DueOf(node, ms).at(0));
    ASSERT_TRUE(foot);
    EXPECT_EQ(foot->sequence, 5);
    EXPECT_EQ(foot->force_N[0], 0.0);
  }
  node.Falsify({});
  const auto foot = can::DecodeFootForces(DueOf(node, 30).at(0));
  EXPECT_EQ(foot->sequence, 6);
  EXPECT_NEAR(foot->force_N[0], 333.0, 0.1 + 1e-9);
}

TEST_F(BodyNode, ALostOneSendsNothing) {
  BodyNodeConfig config = Config(can::BodyPart::kImu);
  config.fault = {BodyFaultKind::kLost, 0.010};
  BodyNodeModel node(config);
  node.Start(0, 0);
  EXPECT_EQ(DueOf(node, 0).size(), 4U);
  for (int ms = 10; ms < 300; ++ms) EXPECT_TRUE(DueOf(node, ms).empty()) << ms;
  node.Falsify({});
  EXPECT_GE(DueOf(node, 300).size(), 3U);
}

TEST_F(BodyNode, APlantWithoutFeetAndImuGivesSamplesThatAreNotValid) {
  for (const can::BodyPart part : {can::BodyPart::kRightFoot, can::BodyPart::kImu}) {
    BodyNodeModel node(Config(part));
    node.Start(0, 0);
    const auto due = node.Due(nullptr, 0);
    const can::Frame& sample = due.begin()[1];
    if (part == can::BodyPart::kImu) {
      EXPECT_FALSE(can::DecodeImuForce(sample)->force_valid);
      EXPECT_TRUE(can::Restore(*can::DecodeImuOrientation(due.begin()[3])));
    } else {
      EXPECT_EQ(can::DecodeFootForces(sample)->valid, (std::array<bool, 4>{}));
    }
  }
}

TEST_F(BodyNode, AnOrientationOfThePlantThatIsNoRotationIsNotValid) {
  body.orientation_wxyz = {0.0, 0.0, 0.0, 0.0};
  BodyNodeModel node(Config(can::BodyPart::kImu));
  node.Start(0, 0);
  const auto force = can::DecodeImuForce(DueOf(node, 0).at(1));
  EXPECT_TRUE(force->force_valid);
  EXPECT_FALSE(force->orientation_valid);
}

TEST(BodyNodeConfiguration, WhatCannotBeIsRefused) {
  const auto refused = [](auto change) {
    VirtualAxesConfig config;
    config.axes.emplace_back();
    config.body_nodes.push_back({0, 40, can::BodyPart::kImu});
    change(config);
    try {
      CheckVirtualAxesConfig(config, 1, 1);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused([](VirtualAxesConfig&) {}), "accepted");
  EXPECT_EQ(refused([](VirtualAxesConfig& c) { c.body_nodes[0].node = c.axes[0].node; }),
            "imu: node 0 is used twice");
  EXPECT_EQ(refused([](VirtualAxesConfig& c) { c.body_nodes[0].bus = 1; }), "imu: no bus 1");
  EXPECT_EQ(refused([](VirtualAxesConfig& c) { c.body_nodes[0].mounting_rpy_rad[0] = NAN; }),
            "imu: mounting_rpy_rad must be finite");
  EXPECT_EQ(refused([](VirtualAxesConfig& c) { c.body_nodes[0].sample_ms = -1; }),
            "imu: periods must not be negative");
  EXPECT_EQ(refused([](VirtualAxesConfig& c) { c.body_nodes[0].fault.after_s = -1.0; }),
            "imu: after_s must not be negative");
}

}  // namespace
}  // namespace sinew::virtual_axes
