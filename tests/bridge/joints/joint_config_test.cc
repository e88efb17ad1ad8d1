// Configurations that are refused, and the identifiers that are received.
#include "bridge/joints/joint_config.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

TEST(BridgeConfig, FiltersLetThroughExactlyWhatIsRead) {
  Bench bench;
  for (const bool masters : {false, true}) {
    const auto filters = ReceiveFilters(bench.config, 0, masters);
    int passed = 0;
    for (std::uint32_t id = 0; id <= can::kMaxStandardId; ++id) {
      can::Frame frame;
      frame.id = id;
      if (can::Passes(filters, frame)) {
        ++passed;
        EXPECT_TRUE(id >> 5 == 1 || id >> 5 == 33);
      }
    }
    EXPECT_EQ(passed, masters ? 9 + 6 : 9);
  }
  EXPECT_TRUE(ReceiveFilters(bench.config, 1).empty());
}

TEST(BridgeConfig, BadValuesAreRefusedWithTheJointsName) {
  can::MemoryBus bus({});
  const auto end = bus.Join("bridge");
  const Bench bench;
  const auto refuse = [&](const std::function<void(BridgeConfig&)>& spoil) {
    BridgeConfig config = bench.config;
    spoil(config);
    try {
      CanPlant(config, {end.get()});
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      if (!config.joints.empty() && config.bitrate_bit_s.size() == 1) {
        EXPECT_NE(std::string(error.what()).find("joint0"), std::string::npos) << error.what();
      }
    }
  };
  EXPECT_NO_THROW(CanPlant(bench.config, {end.get()}));
  refuse([](BridgeConfig& c) { c.joints.clear(); });
  refuse([](BridgeConfig& c) { c.bitrate_bit_s.clear(); });
  refuse([](BridgeConfig& c) { c.joints[0].node = 64; });
  refuse([](BridgeConfig& c) { c.joints[0].bus = 1; });
  refuse([](BridgeConfig& c) { c.joints[0].direction = 2; });
  refuse([](BridgeConfig& c) { c.joints[0].gear_ratio = 0.0; });
  refuse([](BridgeConfig& c) { c.joints[0].torque_constant_Nm_A = -1.0; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.motor_torque_Nm = 0.0; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.lower_rad = 2.0; });
  refuse([](BridgeConfig& c) { c.joints[0].output->node = c.joints[0].node; });
  refuse([](BridgeConfig& c) { c.joints[0].zero_check = ZeroCheck{0.04, 0.0}; });
  refuse([](BridgeConfig& c) { c.joints[0].home_by_whole_turns = true; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.braking = Braking{0.2, 0.1, 0.0}; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.braking = Braking{0.0, 0.1, 0.0}; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.braking = Braking{0.1, 0.1, -1.0}; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.braking = Braking{0.1, 0.1, 40.0}; });  // 39.8
  refuse([](BridgeConfig& c) {  // 0.72 of a turn
    c.joints[0].zero_check = ZeroCheck{0.08, 0.005};
    c.joints[0].home_by_whole_turns = true;
  });
  refuse([](BridgeConfig& c) {
    c.joints[0].zero_check = ZeroCheck{0.04, 0.005};
    c.joints[0].output.reset();
  });
}

}  // namespace
}  // namespace sinew::bridge
