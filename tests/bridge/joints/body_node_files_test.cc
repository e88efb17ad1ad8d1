// The section `body_nodes` of sinew-can-bridge/1 and sinew-virtual-axes/1: what is read, and the
// one line that a mistake is reported with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "bridge/joints/file/bridge_config.h"
#include "bridge/virtual_axes/file/virtual_axes_config.h"

namespace sinew {
namespace {

using ::testing::HasSubstr;

const std::string kJointMap = R"(schema: sinew-can-bridge/1
origin: sim
buses:
  - {name: right, transport: virtual}
  - {name: left, transport: virtual}
joints:
  - name: knee
    bus: right
    node: 3
    gear_ratio: 100
    torque_constant_Nm_A: 0.0159155
    controller_torque_constant_Nm_A: 0.0137833
    limits: {motor_torque_Nm: 0.3, current_A: 20, velocity_rad_s: 4, lower_rad: -1, upper_rad: 1}
)";

const std::string kVirtualAxes = R"(schema: sinew-virtual-axes/1
buses:
  - {name: right, transport: virtual}
  - {name: left, transport: virtual}
axes:
  - {bus: right, node: 3, gear_ratio: 100}
)";

const std::string kBodyNodes = R"(body_nodes:
  - {bus: right, node: 40, sensor: right_foot}
  - {bus: left, node: 40, sensor: left_foot}
  - {bus: left, node: 42, sensor: imu, mounting_rpy_rad: [0, 0.5, -1.5708]}
)";

bridge::BridgeFile ReadMap(const std::string& more) {
  const auto section = config::Section::Parse(kJointMap + more, "map.yaml", "sinew-can-bridge/1");
  bridge::BridgeFile file = config::Read<bridge::BridgeFile>(section);
  section.RejectUnknownKeys();
  return file;
}

virtual_axes::VirtualAxesFile ReadAxesFile(const std::string& more) {
  return config::Read<virtual_axes::VirtualAxesFile>(
      config::Section::Parse(kVirtualAxes + more, "axes.yaml", "sinew-virtual-axes/1"));
}

template <class Read>
std::string ErrorOf(const Read& read, const std::string& more) {
  try {
    (void)read(more);
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0) << text;
    return text;
  }
  return "accepted";
}

std::string Node(const std::string& keys) { return "body_nodes:\n  - {" + keys + "}\n"; }

TEST(BodyNodeFiles, TheJointMapHasBusNumberSensorAndMounting) {
  const bridge::BridgeConfig config = ReadMap(kBodyNodes).bridge;
  ASSERT_EQ(config.body_nodes.size(), 3U);
  EXPECT_EQ(config.body_nodes[0].bus, 0);
  EXPECT_EQ(config.body_nodes[0].node, 40);
  EXPECT_EQ(config.body_nodes[0].part, can::BodyPart::kRightFoot);
  EXPECT_EQ(config.body_nodes[1].bus, 1);
  EXPECT_EQ(config.body_nodes[1].part, can::BodyPart::kLeftFoot);
  EXPECT_EQ(config.body_nodes[2].part, can::BodyPart::kImu);
  EXPECT_EQ(config.body_nodes[2].mounting_rpy_rad, (std::array<double, 3>{0.0, 0.5, -1.5708}));
  EXPECT_TRUE(ReadMap("").bridge.body_nodes.empty());
}

TEST(BodyNodeFiles, MistakesInTheJointMapAreReportedInOneLine) {
  const auto error = [](const std::string& more) { return ErrorOf(ReadMap, more); };
  EXPECT_THAT(error(Node("bus: right, node: 40")), HasSubstr("sensor"));
  EXPECT_THAT(error(Node("bus: right, node: 40, sensor: foot")), HasSubstr("right_foot"));
  EXPECT_THAT(error(Node("node: 40, sensor: imu")), HasSubstr("bus"));
  EXPECT_THAT(error(Node("bus: torso, node: 40, sensor: imu")), HasSubstr("torso"));
  EXPECT_THAT(error(Node("bus: right, node: 64, sensor: imu")), HasSubstr("64"));
  EXPECT_THAT(error(Node("bus: right, node: 3, sensor: imu")),
              HasSubstr("imu of node 3: node 3 is used twice"));
  EXPECT_THAT(error(Node("bus: right, node: 40, sensor: imu, mounting_rpy_rad: [1, 2]")),
              HasSubstr("has 2 numbers, expected 3"));
  EXPECT_THAT(error(Node("bus: right, node: 40, sensor: imu, mounting_rpy_rad: [0, 0, 90]")),
              HasSubstr("mounting_rpy_rad"));
  EXPECT_THAT(error(Node("bus: right, node: 40, sensor: imu, mounting_rpy_deg: [0, 0, 90]")),
              HasSubstr("mounting_rpy_deg"));
  EXPECT_THAT(error(Node("bus: right, node: 40, sensor: left_foot, mounting_rpy_rad: [0, 0, 1]")),
              HasSubstr("mounting_rpy_rad"));
}

TEST(BodyNodeFiles, AGatewayAndANodeForTheSameSensorAreRefused) {
  const auto error = [](const std::string& body) {
    return ErrorOf(ReadMap, "gateways:\n  - {bus: right, node: 48, joints: [knee]" + body + "}\n" +
                                kBodyNodes);
  };
  EXPECT_THAT(error(""), HasSubstr("right foot of node 40: the gateway of node 48 carries the "
                                   "feet already"));
  EXPECT_THAT(error(", body: [imu]"), HasSubstr("imu of node 42: the gateway of node 48 carries "
                                                "the imu already"));
  EXPECT_EQ(error(", body: []"), "accepted");
  EXPECT_THAT(error(", body: [hands]"), HasSubstr("has 'hands', expected feet or imu"));
}

TEST(BodyNodeFiles, VirtualNodesHavePeriodsAndFaults) {
  const auto file = ReadAxesFile(
      "body_nodes:\n  - {bus: left, node: 42, sensor: imu, mounting_rpy_rad: [0, 0, 1], "
      "sample_ms: 4, heartbeat_ms: 200, force_noise_m_s2: 0.05, rate_noise_rad_s: 0.0017, "
      "fault: {kind: frozen, after_s: 5}}\n"
      "  - {bus: right, node: 40, sensor: right_foot, fault: {kind: lost}}\n");
  ASSERT_EQ(file.axes.body_nodes.size(), 2U);
  const virtual_axes::BodyNodeConfig& imu = file.axes.body_nodes[0];
  EXPECT_EQ(imu.bus, 1);
  EXPECT_EQ(imu.node, 42);
  EXPECT_EQ(imu.part, can::BodyPart::kImu);
  EXPECT_EQ(imu.mounting_rpy_rad[2], 1.0);
  EXPECT_EQ(imu.sample_ms, 4);
  EXPECT_EQ(imu.heartbeat_ms, 200);
  EXPECT_EQ(imu.fault.kind, virtual_axes::BodyFaultKind::kFrozen);
  EXPECT_EQ(imu.fault.after_s, 5.0);
  EXPECT_EQ(imu.force_noise_m_s2, 0.05);
  EXPECT_EQ(imu.rate_noise_rad_s, 0.0017);
  EXPECT_EQ(file.axes.body_nodes[1].force_noise_m_s2, 0.0);
  EXPECT_EQ(file.axes.body_nodes[1].fault.kind, virtual_axes::BodyFaultKind::kLost);
  EXPECT_EQ(file.axes.body_nodes[1].sample_ms, 2);
}

TEST(BodyNodeFiles, MistakesOfVirtualNodesAreReportedInOneLine) {
  const auto error = [](const std::string& more) { return ErrorOf(ReadAxesFile, more); };
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: hand")), HasSubstr("left_foot"));
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: imu, fault: {kind: slipped}")),
              HasSubstr("frozen"));
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: imu, fault: {kind: lost, size: 1}")),
              HasSubstr("size"));
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: imu, sample_ms: -1")),
              HasSubstr("sample_ms"));
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: imu, force_noise_m_s2: -1")),
              HasSubstr("force_noise_m_s2"));
  EXPECT_THAT(error(Node("bus: left, node: 40, sensor: left_foot, rate_noise_rad_s: 0.1")),
              HasSubstr("rate_noise_rad_s"));
}

TEST(BodyNodeFiles, AVirtualRobotMayBeHeldAtItsStart) {
  EXPECT_EQ(ReadAxesFile("").axes.hold_start_s, std::nullopt);
  EXPECT_EQ(ReadAxesFile("hold_start_s: 0.5\n").axes.hold_start_s, 0.5);
  EXPECT_THAT(ErrorOf(ReadAxesFile, "hold_start_s: -1\n"), HasSubstr("hold_start_s"));
}

// What bridge and virtual nodes are given side by side is the same text.
TEST(BodyNodeFiles, OneSectionFitsBothFiles) {
  EXPECT_EQ(ReadMap(kBodyNodes).bridge.body_nodes.size(), 3U);
  EXPECT_EQ(ReadAxesFile(kBodyNodes).axes.body_nodes.size(), 3U);
}

}  // namespace
}  // namespace sinew
