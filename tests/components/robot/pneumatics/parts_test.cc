#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/robot/pneumatics/relay.h"
#include "components/robot/pneumatics/stiffness_table.h"

namespace sinew::pneumatics {
namespace {

TEST(Relay, SwitchesNoSoonerThanItMay) {
  Relay relay({.min_on_s = 0.5, .min_off_s = 1.0});
  int on_ticks = 0;
  for (int k = 0; k < 1000; ++k)
    on_ticks += relay.Step(k % 2 == 0, 0.01);  // wanted changes every tick
  // Cycles of about 0.5 s on and 1 s off.
  EXPECT_NEAR(on_ticks, 1000 / 3, 40);
  EXPECT_LE(relay.switches(), 2 * 1000 / 150 + 2);
}

TEST(Relay, ObeysAtOnceAtTheStartAndWhenForced) {
  Relay relay({.min_on_s = 10.0, .min_off_s = 10.0});
  EXPECT_TRUE(relay.Step(true, 0.01));
  EXPECT_TRUE(relay.Step(false, 0.01));
  relay.Force(false);
  EXPECT_FALSE(relay.on());
  EXPECT_FALSE(relay.Step(true, 0.01));
}

TEST(Relay, BadTimesAreRefused) {
  EXPECT_THROW(Relay({.min_on_s = -1.0}), std::invalid_argument);
  EXPECT_THROW(Relay({.min_off_s = std::nan("")}), std::invalid_argument);
}

TEST(StiffnessTable, GoesThroughItsPointsAndBack) {
  const StiffnessTable table({1.0, 2.0, 4.0, 6.0}, {0.5, 10.0, 50.0, 100.0});
  EXPECT_EQ(table.Stiffness_Nm_rad(2.0), 10.0);
  EXPECT_EQ(table.Stiffness_Nm_rad(3.0), 30.0);
  EXPECT_EQ(table.Stiffness_Nm_rad(0.0), 0.5) << "held beyond the end";
  EXPECT_EQ(table.Stiffness_Nm_rad(9.0), 100.0);
  for (double p = 1.0; p <= 6.0; p += 0.1) {
    EXPECT_NEAR(*table.Pressure_bar(table.Stiffness_Nm_rad(p)), p, 1e-12);
  }
  EXPECT_FALSE(table.Pressure_bar(0.4));
  EXPECT_FALSE(table.Pressure_bar(100.1));
  EXPECT_FALSE(table.Pressure_bar(std::nan("")));
}

TEST(StiffnessTable, WithoutPointsThereIsNoStiffness) {
  const StiffnessTable table;
  EXPECT_EQ(table.Stiffness_Nm_rad(3.0), 0.0);
  EXPECT_FALSE(table.Pressure_bar(0.0));
}

TEST(StiffnessTable, BadTablesAreRefused) {
  EXPECT_THROW(StiffnessTable({1.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(StiffnessTable({1.0, 2.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(StiffnessTable({2.0, 1.0}, {1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(StiffnessTable({1.0, 2.0}, {2.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(StiffnessTable({1.0, std::nan("")}, {1.0, 2.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::pneumatics
