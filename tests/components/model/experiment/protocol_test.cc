// Oracle: a toy robot that follows its commands exactly.
#include "components/model/experiment/protocol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"
#include "components/model/experiment/backlash.h"
#include "components/model/experiment/breakaway.h"
#include "components/model/experiment/catalogue.h"
#include "tests/support/allocations.h"
#include "tests/support/rig_constants.h"

namespace sinew::experiment {
namespace {

// Position follows at once; pressure follows compressor and vent.
struct Toy {
  Reading reading{.motor_angle_rad = 20.0,
                  .output_angle_rad = 0.2,
                  .chamber_pressure_bar = 4.0,
                  .reservoir_pressure_bar = 4.0};
  void Step(const Command& command) {
    reading.time_s += kCycle_s;
    if (command.drive == types::ControlMode::kPosition)
      reading.motor_angle_rad = 100.0 * command.position_rad;
    if (command.compressor_on) reading.reservoir_pressure_bar += 0.01;
    if (command.vent_open) reading.reservoir_pressure_bar -= 0.01;
    if (command.valve_open) reading.chamber_pressure_bar = reading.reservoir_pressure_bar;
  }
};

TEST(Prepared, BringsTheRobotToTheStartSlowlyAndThenRunsOnItsOwnClock) {
  Prepared prepared(std::make_unique<BacklashProtocol>(BacklashPlan{.trials = 2}), 100.0);
  Toy toy;
  double fastest_rad_s = 0.0, before_rad = 0.2;
  int cycles = 0;
  while (!prepared.ready() && cycles < 100000) {
    const Command command = prepared.Step(toy.reading);
    if (command.drive == types::ControlMode::kPosition) {
      fastest_rad_s =
          std::max(fastest_rad_s, std::abs(command.position_rad - before_rad) / kCycle_s);
      before_rad = command.position_rad;
    }
    toy.Step(command);
    ++cycles;
  }
  ASSERT_TRUE(prepared.ready());
  EXPECT_LT(fastest_rad_s, 0.5);
  EXPECT_NEAR(toy.reading.motor_angle_rad / 100.0, 0.0, 0.02);
  EXPECT_NEAR(toy.reading.chamber_pressure_bar, 1.617, 0.1);
  const double start_s = toy.reading.time_s;
  while (!prepared.done() && toy.reading.time_s < start_s + 10.0) {
    toy.Step(prepared.Step(toy.reading));
  }
  EXPECT_NEAR(toy.reading.time_s - prepared.started_s(), 5.0, 0.1);  // two periods
}

TEST(Protocols, EveryOneStepsWithoutAllocationAndEndsInTime) {
  for (const std::string& name : ExperimentNames()) {
    const auto protocol = MakeProtocol(name, {.trials = 2, .quick = true, .rest_s = 0.5});
    Toy toy;
    const double longest_s = 3.0 * protocol->expected_s() + 60.0;
    const long before = test::Allocations();
    while (!protocol->done() && toy.reading.time_s < longest_s) {
      toy.Step(protocol->Step(toy.reading));
    }
    const long after = test::Allocations();
    EXPECT_TRUE(protocol->done()) << name;
    EXPECT_EQ(after, before) << name;
  }
}

TEST(Protocols, CommandsStayFiniteWhenSensorsAreNot) {
  for (const char* name : {"backlash", "motor", "sea-data"}) {
    const auto protocol = MakeProtocol(name, {});
    Reading reading;
    reading.time_s = 0.1;
    EXPECT_TRUE(std::isfinite(protocol->Step(reading).motor_torque_Nm)) << name;
  }
}

TEST(Protocols, AnUnknownNameIsReportedWithTheKnownOnes) {
  try {
    (void)MakeProtocol("wobble", {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("moving-friction"), std::string::npos);
  }
}

TEST(Protocols, PlansThatMakeNoSenseAreRefused) {
  EXPECT_THROW(BacklashProtocol({.trials = 0}), std::invalid_argument);
  EXPECT_THROW(BreakawayProtocol({.rate_N_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(BreakawayTour({}, {}, 100.0), std::invalid_argument);
}

TEST(PressureKeeper, FillsBelowVentsAboveAndRestsInItsBand) {
  const PressureKeeper keeper{.target_bar = 3.0};
  Command command;
  keeper.Apply({.reservoir_pressure_bar = 2.0}, &command);
  EXPECT_TRUE(command.compressor_on);
  EXPECT_FALSE(command.vent_open);
  keeper.Apply({.reservoir_pressure_bar = 4.0}, &command);
  EXPECT_FALSE(command.compressor_on);
  EXPECT_TRUE(command.vent_open);
  keeper.Apply({.reservoir_pressure_bar = 3.0}, &command);
  EXPECT_FALSE(command.compressor_on || command.vent_open);
}

TEST(Person, IsTheSameForASeedAndFillsItsRange) {
  Person one(5), two(5), other(6);
  double lowest = 1.0, highest = 0.0;
  bool differs = false;
  for (int i = 0; i < 1000; ++i) {
    const double value = one.Uniform(0.0, 1.0);
    ASSERT_EQ(value, two.Uniform(0.0, 1.0));
    differs = differs || value != other.Uniform(0.0, 1.0);
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  EXPECT_TRUE(differs);
  EXPECT_LT(lowest, 0.02);
  EXPECT_GT(highest, 0.98);
}

}  // namespace
}  // namespace sinew::experiment
