// Feet and IMU as nodes of their own: the bridge's plant and virtual nodes on two buses; what a
// lost or a forged node changes, and that no joint stops for it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/bridge/joints/plant_bench.h"
#include "tests/support/allocations.h"

namespace sinew::bridge {
namespace {

using virtual_axes::BodyFaultKind;

constexpr int kRightFoot = 0, kLeftFoot = 1, kImu = 2;  // in the configuration's order
constexpr std::array<double, 3> kMounting_rad = {0.3, -0.4, 1.2};

// Each foot on its leg's bus, the IMU on the second.
class BodyBench : public Bench {
 public:
  BodyBench() : Bench({.joints = 2, .buses = 2, .output_nodes = false}) {
    config.body_nodes = {{0, 40, can::BodyPart::kRightFoot},
                         {1, 40, can::BodyPart::kLeftFoot},
                         {1, 42, can::BodyPart::kImu, kMounting_rad}};
    for (const BodyNodeConfig& c : config.body_nodes) {
      virtual_axes::BodyNodeConfig node;
      node.bus = c.bus;
      node.node = c.node;
      node.part = c.part;
      node.mounting_rpy_rad = c.mounting_rpy_rad;
      axes_config.body_nodes.push_back(node);
    }
    provider::BodySensors& body = rotors.body.emplace();
    for (std::size_t i = 0; i < 8; ++i) body.foot_force_N[i] = 12.4 * static_cast<double>(i);
    body.foot_valid.fill(true);
    body.acceleration_m_s2 = {0.5, -1.25, 9.81};
    body.angular_velocity_rad_s = {0.125, -2.5, 0.003};
    body.orientation_wxyz = {std::cos(0.2), 0.0, std::sin(0.2), 0.0};  // 0.4 rad of pitch
    body.imu_valid = true;
  }
  const provider::BodySensors& body() const { return *plant->body_sensors(); }
  BodyCounts counts(int node) const {
    return plant->body_nodes()[static_cast<std::size_t>(node)].counts();
  }
};

TEST(BodyNodes, FeetAndImuAreReportedInTheTorsosAxes) {
  BodyBench bench;
  bench.Start();
  bench.Steps(30);  // a heartbeat of each node
  const provider::BodySensors& truth = *bench.rotors.body;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(bench.body().foot_force_N[i], truth.foot_force_N[i], 0.1 + 1e-9) << i;
    EXPECT_TRUE(bench.body().foot_valid[i]) << i;
  }
  // Half a step on each axis of the housing.
  const double axes = std::sqrt(3.0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(bench.body().acceleration_m_s2[i], truth.acceleration_m_s2[i], axes * 0.0025);
    EXPECT_NEAR(bench.body().angular_velocity_rad_s[i], truth.angular_velocity_rad_s[i],
                axes * 0.0005);
  }
  const double sign = bench.body().orientation_wxyz[0] < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(sign * bench.body().orientation_wxyz[i], truth.orientation_wxyz[i], 4e-5) << i;
  }
  EXPECT_TRUE(bench.body().imu_valid);
  for (int node = 0; node < 3; ++node) {
    EXPECT_EQ(bench.counts(node).lost, 0U) << node;
    EXPECT_EQ(bench.counts(node).samples_missed, 0U) << node;
  }
  EXPECT_EQ(bench.plant->malformed(), 0U);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(BodyNodes, ASensorThatThePlantDoesNotHaveIsNotValid) {
  BodyBench bench;
  bench.rotors.body->foot_valid[2] = false;
  bench.rotors.body->imu_valid = false;
  bench.Start();
  bench.Steps(30);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(bench.body().foot_valid[i], i != 2) << i;
  EXPECT_FALSE(bench.body().imu_valid);
}

TEST(BodyNodes, AFrozenNodeIsNotValidAndLostAndComesBack) {
  BodyBench bench;
  bench.Start();
  bench.Steps(30);
  bench.axes->FalsifyBodyNode(kLeftFoot, {BodyFaultKind::kFrozen, 0.0});
  bench.Steps(7);  // 29 ms
  EXPECT_FALSE(bench.body().foot_valid[4]);
  EXPECT_TRUE(bench.body().foot_valid[0]);
  EXPECT_TRUE(bench.body().imu_valid);
  EXPECT_EQ(bench.counts(kLeftFoot).lost, 0U);
  bench.Steps(30);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[0], 0U);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[1], 1U);
  bench.axes->FalsifyBodyNode(kLeftFoot, {});
  bench.Steps(2);
  EXPECT_TRUE(bench.body().foot_valid[4]);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[1], 1U);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(BodyNodes, NoJointStopsForNodesThatAreLost) {
  BodyBench bench;
  bench.Start();
  bench.Arm(ControlMode::kTorque);
  bench.command.motor_torque_Nm[0] = bench.command.motor_torque_Nm[1] = 0.0005;
  for (const int node : {kRightFoot, kLeftFoot, kImu}) {
    bench.axes->FalsifyBodyNode(node, {BodyFaultKind::kLost, 0.0});
  }
  bench.Steps(40);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_FALSE(bench.body().foot_valid[i]) << i;
  EXPECT_FALSE(bench.body().imu_valid);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[0], 1U);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[1], 2U);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(bench.axes->axis_state(static_cast<int>(j)), can::AxisState::kClosedLoopControl);
    EXPECT_NEAR(bench.rotors.torque_Nm[j], 0.0005, 1e-9) << j;
    EXPECT_TRUE(bench.sensors.valid[j]) << j;
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(BodyNodes, TheStartDoesNotWaitForThem) {
  BodyBench bench;
  bench.axes_config.body_nodes.clear();
  bench.Start();
  bench.Arm();
  EXPECT_FALSE(bench.body().foot_valid[0]);
  EXPECT_FALSE(bench.body().imu_valid);
  EXPECT_EQ(bench.body().orientation_wxyz[0], 1.0);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[0], 1U);
  EXPECT_EQ(bench.plant->bus_report()->body_nodes_lost[1], 2U);
}

// Frames of a foot or an IMU under any other number than the node's, or on another bus, and frames
// of the wrong kind under its number.
TEST(BodyNodes, ForgedFramesChangeNothing) {
  const BodyBench bench;
  Deaf first, second;
  first.frames = {can::Encode(1, can::Heartbeat{0, can::AxisState::kIdle}),
                  can::Encode(1, can::EncoderEstimates{}),
                  can::Encode(2, can::Heartbeat{0, can::AxisState::kIdle}),
                  can::Encode(2, can::EncoderEstimates{})};
  BridgeConfig config = bench.config;
  config.joints[1].bus = 0;
  CanPlant plant(config, {&first, &second});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  const can::FootForces forces{{99.0, 99.0, 99.0, 99.0}, {true, true, true, true}, 5};
  const std::size_t honest = first.frames.size();
  for (int node = 0; node <= can::kMaxNode; ++node) {
    if (node == 1 || node == 2 || node == 40) continue;
    first.frames.push_back(can::Encode(node, can::NodeHeartbeat{}));
    first.frames.push_back(can::Encode(node, forces));
    second.frames.push_back(can::Encode(node == 42 ? 41 : node, forces));
  }
  first.frames.push_back(can::Encode(40, can::NodeHeartbeat{}));
  first.frames.push_back(can::Encode(40, can::ImuForce{{9.0, 9.0, 9.0}, 1, true, true, true}));
  can::Frame cut = can::Encode(40, forces);
  cut.length = 6;
  first.frames.push_back(cut);
  can::Frame remote = can::Encode(40, forces);
  remote.remote = true;
  first.frames.push_back(remote);
  can::Frame extended = can::Encode(40, forces);
  extended.extended = true;
  first.frames.push_back(extended);
  plant.Step({}, kPeriod_s, &sensors);
  EXPECT_EQ(plant.body_sensors()->foot_force_N, (std::array<double, 8>{}));
  EXPECT_EQ(plant.body_sensors()->foot_valid, (std::array<bool, 8>{}));
  EXPECT_EQ(plant.body_sensors()->acceleration_m_s2, (std::array<double, 3>{}));
  EXPECT_EQ(plant.malformed(), 1U) << "the short one";
  first.frames.resize(honest);
  first.frames.push_back(can::Encode(40, forces));
  first.next = 0;
  plant.Step({}, kPeriod_s, &sensors);
  EXPECT_NEAR(plant.body_sensors()->foot_force_N[0], 99.0, 1e-9) << "the node's own counts";
  EXPECT_TRUE(plant.body_sensors()->foot_valid[0]);
}

TEST(BodyNodes, AGatewayThatCarriesTheFeetLeavesTheImuToItsNode) {
  Bench bench({.joints = 2, .output_nodes = false, .gateway = true});
  bench.config.gateways[0].carries_imu = false;
  bench.config.body_nodes = {{0, 42, can::BodyPart::kImu}};
  virtual_axes::BodyNodeConfig node;
  node.node = 42;
  node.part = can::BodyPart::kImu;
  bench.axes_config.body_nodes = {node};
  provider::BodySensors& body = bench.rotors.body.emplace();
  body.foot_force_N[3] = 12.3;
  body.acceleration_m_s2 = {0.0, 0.0, 9.814};  // 9.81 in the steps of the gateway
  body.imu_valid = true;
  bench.Start();
  bench.Steps(30);
  EXPECT_NEAR(bench.plant->body_sensors()->foot_force_N[3], 12.3, 0.051);
  EXPECT_TRUE(bench.plant->body_sensors()->foot_valid[3]);
  EXPECT_NEAR(bench.plant->body_sensors()->acceleration_m_s2[2], 9.815, 1e-9);
  EXPECT_TRUE(bench.plant->body_sensors()->imu_valid);
  bench.axes->FalsifyBodyNode(0, {BodyFaultKind::kLost, 0.0});
  bench.Steps(10);
  EXPECT_FALSE(bench.plant->body_sensors()->imu_valid);
  EXPECT_TRUE(bench.plant->body_sensors()->foot_valid[3]);
}

TEST(BodyNodes, ActAndStepTakeNothingFromTheHeap) {
  Bench bench({.joints = 1, .output_nodes = false});
  bench.config.body_nodes = {{0, 40, can::BodyPart::kRightFoot}, {0, 42, can::BodyPart::kImu}};
  Deaf bus;
  bus.frames = {can::Encode(1, can::Heartbeat{0, can::AxisState::kIdle}),
                can::Encode(1, can::EncoderEstimates{}),
                can::Encode(40, can::NodeHeartbeat{}),
                can::Encode(42, can::NodeHeartbeat{}),
                can::Encode(40, can::FootForces{}),
                can::Encode(42, can::ImuForce{}),
                can::Encode(42, can::ImuRate{}),
                can::Encode(42, can::ImuOrientation{})};
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  const provider::PlantCommand command;
  const long before = test::Allocations();
  for (int i = 0; i < 500; ++i) {
    bus.now += kPeriod_ns;
    bus.next = 0;
    for (std::size_t k = 4; k < 8; ++k) {
      bus.frames[k].data[6] = static_cast<std::uint8_t>(i << 4);  // sequences of both nodes
    }
    plant.Act(command, kPeriod_s);
    plant.Step(command, kPeriod_s, &sensors);
  }
  EXPECT_EQ(test::Allocations() - before, 0);
}

TEST(BodyNodes, ConfigurationThatCannotBeIsRefused) {
  const auto refused = [](auto change) {
    BodyBench bench;
    change(bench.config);
    return RefusalOf(bench.config);
  };
  EXPECT_EQ(refused([](BridgeConfig&) {}), "accepted");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[0].node = 1; }),
            "right foot of node 1: node 1 is used twice");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[2].node = 40; }),
            "imu of node 40: node 40 is used twice");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[0].node = 64; }),
            "right foot of node 64: node 64, expected 0 to 63");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[1].bus = 2; }),
            "left foot of node 40: no bus 2");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[1].part = can::BodyPart::kRightFoot; }),
            "right foot of node 40: another node measures the right foot");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[2].mounting_rpy_rad[1] = NAN; }),
            "imu of node 42: mounting_rpy_rad must be finite");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.body_nodes[0].mounting_rpy_rad[1] = 1.0; }),
            "right foot of node 40: mounting_rpy_rad is for an imu");
  const auto with_gateway = [](bool feet, bool imu) {
    return [feet, imu](BridgeConfig& c) { c.gateways.push_back({0, 48, {0}, feet, imu}); };
  };
  EXPECT_EQ(refused(with_gateway(true, false)),
            "right foot of node 40: the gateway of node 48 carries the feet already");
  EXPECT_EQ(refused(with_gateway(false, true)),
            "imu of node 42: the gateway of node 48 carries the imu already");
  EXPECT_EQ(refused(with_gateway(false, false)), "accepted");
}

TEST(BodyNodes, FiltersLetThroughExactlyTheirFrames) {
  const BodyBench bench;
  const auto filters = ReceiveFilters(bench.config, 1);
  std::vector<std::uint32_t> passed;
  for (std::uint32_t id = 40U << 5; id <= can::kMaxStandardId; ++id) {
    can::Frame frame;
    frame.id = id;
    if (can::Passes(filters, frame)) passed.push_back(id);
  }
  EXPECT_EQ(passed,
            (std::vector<std::uint32_t>{40U << 5 | 0x01, 40U << 5 | 0x0C, 42U << 5 | 0x01,
                                        42U << 5 | 0x0D, 42U << 5 | 0x0E, 42U << 5 | 0x0F}));
}

}  // namespace
}  // namespace sinew::bridge
