#include "components/base/types/unit_name.h"

#include <gtest/gtest.h>

namespace sinew::types {
namespace {

TEST(SplitUnit, TheUnitStandsBehindTheName) {
  const struct {
    const char *name, *stem, *unit;
  } kCases[] = {{"position_rad", "position", "rad"},
                {"velocity_rad_s", "velocity", "rad/s"},
                {"acceleration_m_s2", "acceleration", "m/s^2"},
                {"square_error_rad2", "square_error", "rad^2"},
                {"viscous_Nm_s_rad", "viscous", "Nm s/rad"},
                {"inertia_kg_m2", "inertia", "kg m^2"},
                {"rise_per_s", "rise", "1/s"},
                {"gain_Nm_rad_bar", "gain", "Nm/(rad bar)"},
                {"valve_open", "valve_open", ""},
                {"rad", "rad", ""},
                {"", "", ""}};
  for (const auto& one : kCases) {
    const UnitName split = SplitUnit(one.name);
    EXPECT_EQ(split.stem, one.stem) << one.name;
    EXPECT_EQ(split.unit, one.unit) << one.name;
  }
}

}  // namespace
}  // namespace sinew::types
