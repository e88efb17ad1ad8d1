// The manager against a small gas model: it holds, does not hunt, and reports each fault.
#include "components/robot/pneumatics/manager.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/components/robot/pneumatics/gas_model.h"
#include "tests/support/allocations.h"

namespace sinew::pneumatics {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

ManagerConfig RigConfig(HoldWith hold_with = HoldWith::kReservoir) {
  ManagerConfig config;
  config.hold_with = hold_with;
  config.target_bar = 4.0;
  config.reservoir_sensor = true;
  config.valve_feedback = true;
  return config;
}

struct Bench {
  PressureManager manager;
  GasModel gas;
  ManagerOutput out;
  double time_s = 0.0;

  explicit Bench(const ManagerConfig& config) : manager(config) {}

  ManagerInput Read() {
    ManagerInput input;
    input.period_s = kPeriod_s;
    input.active = true;
    input.valid = true;
    input.chamber_bar = gas.Sensor();
    input.reservoir_bar = gas.reservoir_bar;
    input.valve_is_open = gas.valve_is_open;
    return input;
  }
  void Step(const ManagerInput& input) {
    out = manager.Step(input);
    EXPECT_FALSE(out.compressor_on && out.vent_open) << "fights itself at " << time_s;
    gas.Step(out.valve_open, out.compressor_on, out.vent_open, kPeriod_s);
    time_s += kPeriod_s;
  }
  void Run(
      double seconds, const std::function<void()>& each = [] {}) {
    for (const double end_s = time_s + seconds; time_s < end_s;) {
      Step(Read());
      each();
    }
  }
};

TEST(PressureManager, AllRelaysAreOffUntilItIsActive) {
  Bench bench(RigConfig());
  for (int k = 0; k < 1000; ++k) {
    ManagerInput input = bench.Read();
    input.active = false;
    bench.Step(input);
    EXPECT_EQ(bench.out.mode, Mode::kIdle);
    EXPECT_FALSE(bench.out.valve_open || bench.out.compressor_on || bench.out.vent_open);
  }
  EXPECT_EQ(bench.manager.switches(), 0);
}

TEST(PressureManager, FillsAndHoldsWithinItsBandWithoutHunting) {
  for (const HoldWith hold_with : {HoldWith::kReservoir, HoldWith::kChamber}) {
    for (const double target_bar : {0.5, 2.0, 4.0, 6.0}) {
      ManagerConfig config = RigConfig(hold_with);
      config.target_bar = target_bar;
      Bench bench(config);
      bench.Run(60.0);
      EXPECT_EQ(bench.out.fault, Fault::kNone) << FaultText(bench.out.fault);
      EXPECT_TRUE(bench.out.settled) << target_bar << " bar";
      const long before = bench.manager.switches();
      bench.Run(120.0,
                [&] { ASSERT_NEAR(bench.gas.chamber_bar, target_bar, 0.05) << bench.time_s; });
      EXPECT_LE(bench.manager.switches() - before, 2) << "tight air needs no relay";
      EXPECT_EQ(bench.out.mode, Mode::kHold);
    }
  }
}

TEST(PressureManager, AShutChambersValveShutsOnceNoCorrectionWasNeededForTheCalmTime) {
  ManagerConfig config = RigConfig(HoldWith::kChamber);
  config.calm_s = 5.0;
  Bench bench(config);
  double joined_s = -1.0, shut_s = -1.0, last_correction_s = 0.0;
  bench.Run(60.0, [&] {
    if (bench.out.mode != Mode::kHold) last_correction_s = bench.time_s;
    if (joined_s < 0.0 && bench.out.settled) joined_s = bench.time_s;
    if (joined_s < 0.0 || shut_s >= 0.0) return;
    if (!bench.out.valve_open) shut_s = bench.time_s;
  });
  ASSERT_GE(joined_s, 0.0);
  ASSERT_GE(shut_s, 0.0) << "never shut";
  // What coming to rest and joining took counts: settle_s.
  EXPECT_GE(shut_s - last_correction_s, config.calm_s - config.settle_s - 2.0 * kPeriod_s);
  EXPECT_FALSE(bench.out.valve_open);
}

TEST(PressureManager, FollowsTargetsUpAndDown) {
  for (const HoldWith hold_with : {HoldWith::kReservoir, HoldWith::kChamber}) {
    Bench bench(RigConfig(hold_with));
    bench.Run(60.0);
    for (const double target_bar : {5.0, 2.0, 3.0, 0.0}) {
      EXPECT_TRUE(bench.manager.RequestPressure(target_bar));
      bench.Run(target_bar == 0.0 ? 400.0 : 120.0);
      EXPECT_EQ(bench.out.fault, Fault::kNone)
          << FaultText(bench.out.fault) << " to " << target_bar;
      EXPECT_NEAR(bench.gas.chamber_bar, target_bar, 0.05);
      EXPECT_TRUE(bench.out.settled) << target_bar;
    }
  }
}

TEST(PressureManager, HoldsWhileTheLinkMoves) {
  Bench bench(RigConfig());
  bench.Run(60.0);
  const long before = bench.manager.switches();
  double worst_bar = 0.0;
  bench.Run(100.0, [&] {  // 30 degrees at 0.4 Hz: 3.6e-6 m3 a radian
    bench.gas.SetChamberVolume(1.2e-4 +
                               3.6e-6 * 0.52 * std::sin(2.0 * 3.14159265 * 0.4 * bench.time_s));
    worst_bar = std::max(worst_bar, std::abs(bench.gas.chamber_bar - 4.0));
  });
  EXPECT_LE(worst_bar, 0.05);
  EXPECT_LE(bench.manager.switches() - before, 4);
  EXPECT_EQ(bench.out.fault, Fault::kNone);
}

TEST(PressureManager, RefillsASmallLeakAndKeepsTheBand) {
  Bench bench(RigConfig());
  bench.gas.leak_kg_s_bar = 3e-6;  // 0.005 bar/s at 4 bar: far under its limit
  bench.Run(60.0);
  const long before = bench.manager.switches();
  bench.Run(300.0, [&] { ASSERT_NEAR(bench.gas.chamber_bar, 4.0, 0.05) << bench.time_s; });
  EXPECT_EQ(bench.out.fault, Fault::kNone);
  // A fill of about 0.04 bar every 8 s: on and off.
  EXPECT_LE(bench.manager.switches() - before, 2 * 300 / 5);
  EXPECT_NEAR(bench.manager.leak_bar_s(), 1e-5 * GasModel::kRT / 2.12e-3 * 3e-6 * 4.0, 0.002);
}

TEST(PressureManager, ALargeLeakIsReportedAndEndsInTheSafeState) {
  Bench bench(RigConfig());
  bench.Run(60.0);
  bench.gas.leak_kg_s_bar = 3e-5;  // 0.05 bar/s
  bench.Run(60.0);
  EXPECT_EQ(bench.out.fault, Fault::kLeak);
  EXPECT_EQ(bench.out.mode, Mode::kSafe);
  EXPECT_FALSE(bench.out.compressor_on);
  EXPECT_TRUE(bench.out.valve_open && bench.out.vent_open) << "lets the air out";
}

TEST(PressureManager, StuckPartsAreReported) {
  const struct {
    const char* what;
    std::function<void(GasModel&)> break_it;
    bool feedback;
    HoldWith hold_with;
    Fault fault;
  } kCases[] = {
      {"valve shut, with contact", [](GasModel& g) { g.valve_stuck_shut = true; }, true,
       HoldWith::kReservoir, Fault::kValve},
      {"valve shut, without contact", [](GasModel& g) { g.valve_stuck_shut = true; }, false,
       HoldWith::kReservoir, Fault::kNoResponse},
      {"valve open, with contact", [](GasModel& g) { g.valve_stuck_open = true; }, true,
       HoldWith::kChamber, Fault::kValve},
      {"compressor dead", [](GasModel& g) { g.compressor_dead = true; }, true, HoldWith::kReservoir,
       Fault::kNoResponse},
  };
  for (const auto& c : kCases) {
    ManagerConfig config = RigConfig(c.hold_with);
    config.valve_feedback = c.feedback;
    Bench bench(config);
    c.break_it(bench.gas);
    bench.Run(120.0);
    EXPECT_EQ(bench.out.fault, c.fault) << c.what << ": " << FaultText(bench.out.fault);
    EXPECT_EQ(bench.out.mode, Mode::kSafe) << c.what;
  }
}

TEST(PressureManager, ACompressorThatDoesNotStopIsReportedBeforeThePressureIsTooHigh) {
  ManagerConfig config = RigConfig();
  Bench bench(config);
  bench.Run(60.0);
  bench.gas.compressor_stuck_on = true;
  double highest_bar = 0.0;
  bench.Run(60.0, [&] { highest_bar = std::max(highest_bar, bench.gas.chamber_bar); });
  EXPECT_EQ(bench.out.fault, Fault::kRises);
  EXPECT_EQ(bench.out.mode, Mode::kSafe);
  EXPECT_LT(highest_bar, config.max_pressure_bar + 0.1);
}

TEST(PressureManager, ABadSensorIsReportedAfterItsTimeAndNothingRunsMeanwhile) {
  for (const double reading : {std::nan(""), 11.0, -3.0}) {
    Bench bench(RigConfig());
    bench.Run(2.0);
    EXPECT_TRUE(bench.out.compressor_on);
    bench.gas.sensor_override_bar = reading;
    bench.Run(0.02);
    EXPECT_FALSE(bench.out.compressor_on) << "at once";
    EXPECT_TRUE(bench.out.sensor_fault);
    EXPECT_EQ(bench.out.fault, Fault::kNone) << "one bad sample is no fault";
    EXPECT_TRUE(std::isfinite(bench.out.pressure_bar));
    bench.Run(0.1);
    EXPECT_EQ(bench.out.fault, Fault::kSensor);
    EXPECT_EQ(bench.out.mode, Mode::kSafe);
  }
}

TEST(PressureManager, AShortGlitchOfTheSensorPasses) {
  Bench bench(RigConfig());
  bench.Run(60.0);
  for (int i = 0; i < 20; ++i) {
    bench.gas.sensor_override_bar = std::nan("");
    bench.Run(2.0 * kPeriod_s);
    bench.gas.sensor_override_bar.reset();
    bench.Run(0.5);
  }
  EXPECT_EQ(bench.out.fault, Fault::kNone);
  EXPECT_TRUE(bench.out.settled);
}

TEST(PressureManager, TooMuchPressureIsAFault) {
  Bench bench(RigConfig());
  bench.gas.sensor_override_bar = 7.2;
  bench.Run(0.5);
  EXPECT_EQ(bench.out.fault, Fault::kOverpressure);
}

TEST(PressureManager, AFaultStaysUntilReset) {
  Bench bench(RigConfig());
  bench.gas.sensor_override_bar = 7.2;
  bench.Run(0.5);
  bench.gas.sensor_override_bar.reset();
  bench.Run(5.0);
  EXPECT_EQ(bench.out.mode, Mode::kSafe);
  ManagerInput input = bench.Read();
  input.reset = true;
  bench.Step(input);
  EXPECT_EQ(bench.out.fault, Fault::kNone);
  EXPECT_EQ(bench.out.mode, Mode::kFill);
  EXPECT_EQ(bench.out.target_bar, 4.0);
}

TEST(PressureManager, SafeStateByConfigurationKeepsTheAirIn) {
  ManagerConfig config = RigConfig();
  config.vent_when_safe = false;
  Bench bench(config);
  bench.gas.sensor_override_bar = 7.2;
  bench.Run(0.5);
  EXPECT_EQ(bench.out.mode, Mode::kSafe);
  EXPECT_FALSE(bench.out.valve_open || bench.out.vent_open || bench.out.compressor_on);
}

TEST(PressureManager, LostSamplesStopCompressorAndVentButAreNoFault) {
  Bench bench(RigConfig());
  bench.Run(2.0);
  EXPECT_TRUE(bench.out.compressor_on);
  ManagerInput input = bench.Read();
  input.valid = false;
  for (int k = 0; k < 240; ++k) bench.Step(input);
  EXPECT_FALSE(bench.out.compressor_on || bench.out.vent_open);
  EXPECT_EQ(bench.out.fault, Fault::kNone);
  EXPECT_FALSE(bench.out.settled);
  bench.Run(60.0);
  EXPECT_TRUE(bench.out.settled);
}

TEST(PressureManager, HoldsAStiffnessThroughTheTable) {
  ManagerConfig config = RigConfig();
  config.stiffness = StiffnessTable({2.0, 4.0, 6.0}, {10.0, 50.0, 100.0});
  Bench bench(config);
  EXPECT_TRUE(bench.manager.RequestStiffness(30.0));
  EXPECT_EQ(bench.manager.target_bar(), 3.0);
  EXPECT_FALSE(bench.manager.RequestStiffness(5.0)) << "under the table";
  EXPECT_FALSE(bench.manager.RequestStiffness(std::nan("")));
  EXPECT_EQ(bench.manager.target_bar(), 3.0) << "the old one stays";
  bench.Run(60.0);
  EXPECT_NEAR(bench.out.stiffness_Nm_rad, 30.0, 1.0);
}

TEST(PressureManager, TargetsStayInsideTheirLimits) {
  PressureManager manager(RigConfig());
  EXPECT_TRUE(manager.RequestPressure(9.0));
  EXPECT_EQ(manager.target_bar(), 6.0);
  EXPECT_TRUE(manager.RequestPressure(-1.0));
  EXPECT_EQ(manager.target_bar(), 0.0);
  EXPECT_FALSE(manager.RequestPressure(std::nan("")));
}

TEST(PressureManager, RelaysKeepTheirLeastTimes) {
  ManagerConfig config = RigConfig();
  config.compressor = {1.0, 2.0};
  config.settle_s = 0.0;
  config.start_band_bar = 0.001;  // would hunt
  config.leak_limit_bar_s = 10.0;
  Bench bench(config);
  bench.gas.chamber_bar = bench.gas.reservoir_bar = 4.0;
  bench.gas.leak_kg_s_bar = 3e-5;
  bool on = false;
  double since_s = 10.0;
  for (int k = 0; k < 240 * 60; ++k) {
    bench.Step(bench.Read());
    since_s += kPeriod_s;
    if (bench.out.compressor_on != on) {
      EXPECT_GE(since_s, (on ? 1.0 : 2.0) - kPeriod_s) << bench.time_s;
      on = !on;
      since_s = 0.0;
    }
  }
}

TEST(PressureManager, AMillionStepsAllocateNothing) {
  PressureManager manager(RigConfig());
  ManagerInput input;
  input.period_s = kPeriod_s;
  input.active = input.valid = true;
  const long before = test::Allocations();
  for (int k = 0; k < 1000000; ++k) {
    input.chamber_bar = 4.0 + 0.2 * std::sin(1e-3 * k);
    input.valve_is_open = true;
    input.reset = k % 100000 == 0;
    const ManagerOutput out = manager.Step(input);
    ASSERT_TRUE(std::isfinite(out.pressure_bar));
  }
  EXPECT_EQ(test::Allocations() - before, 0);
}

TEST(PressureManager, BadConfigurationIsRefused) {
  const std::function<void(ManagerConfig&)> kSpoil[] = {
      [](ManagerConfig& c) { c.target_bar = 7.0; },
      [](ManagerConfig& c) { c.band_bar = 0.0; },
      [](ManagerConfig& c) { c.start_band_bar = 0.06; },
      [](ManagerConfig& c) { c.max_pressure_bar = 5.0; },
      [](ManagerConfig& c) { c.sensor_upper_bar = 6.0; },
      [](ManagerConfig& c) { c.filter_Hz = std::nan(""); },
      [](ManagerConfig& c) { c.valve.min_on_s = -1.0; },
      [](ManagerConfig& c) { c.leak_window_s = 0.0; },
      [](ManagerConfig& c) { c.response_bar = HUGE_VAL; },
  };
  for (const auto& spoil : kSpoil) {
    ManagerConfig config = RigConfig();
    spoil(config);
    EXPECT_THROW(PressureManager{config}, std::invalid_argument);
  }
}

// The owner shuts the valve that this one would hold open, and lets the pressure fall.
TEST(PressureManager, AStandbyChecksNeitherTheOwnersRelaysNorWhatThePressureDoes) {
  Bench bench(RigConfig());
  for (int k = 0; k < 60 * 240; ++k) {
    ManagerInput input = bench.Read();
    input.standby = true;
    input.valve_is_open = false;
    input.chamber_bar = 4.0 - 0.05 * k * kPeriod_s;  // above leak_limit_bar_s
    bench.out = bench.manager.Step(input);
    ASSERT_EQ(bench.out.fault, Fault::kNone) << k;
    ASSERT_FALSE(bench.out.compressor_on || bench.out.vent_open || bench.out.valve_open);
  }
  EXPECT_NEAR(bench.out.pressure_bar, 1.0, 0.01) << "it knows the pressure when it takes over";
  bench.Step(bench.Read());
  EXPECT_EQ(bench.out.fault, Fault::kNone);
}

TEST(PressureManager, AStandbyStillWatchesTheSensors) {
  Bench bench(RigConfig());
  for (int k = 0; k < 240; ++k) {
    ManagerInput input = bench.Read();
    input.standby = true;
    input.chamber_bar = 7.5;
    bench.out = bench.manager.Step(input);
  }
  EXPECT_EQ(bench.out.fault, Fault::kOverpressure);
}

}  // namespace
}  // namespace sinew::pneumatics
