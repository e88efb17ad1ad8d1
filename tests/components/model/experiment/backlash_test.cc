// Oracle: rows of a play and a contact compliance that were put in.
#include "components/model/experiment/backlash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/support/rig_constants.h"

namespace sinew::experiment {
namespace {

Recording Synthetic(double play_deg, double compliance_rad_Nm, int trials, bool two_torques) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  const RigConstants rig;
  Recording rows;
  for (int i = 0; i < trials * 600; ++i) {
    const double t = i / 240.0;
    const int trial = i / 600;
    const double side = i % 600 < 300 ? 1.0 : -1.0;
    const double torque_Nm = two_torques && trial % 2 == 1 ? 0.01 : 0.02;
    Row row;
    row.time_s = t;
    row.motor_current_A = side * torque_Nm / rig.torque_constant_Nm_A + 0.03 * gauss(random);
    const double tooth_Nm = rig.efficiency * rig.gear_ratio * torque_Nm;
    const double d_rad = side * (0.5 * play_deg * kDegree + compliance_rad_Nm * tooth_Nm);
    row.output_angle_rad = kCount_rad * std::round((0.01 + 1.5e-4 * gauss(random)) / kCount_rad);
    row.motor_angle_rad = rig.gear_ratio * (0.01 + d_rad);
    rows.push_back(row);
  }
  return rows;
}

TEST(Backlash, PlayAndComplianceComeBack) {
  const Result result = IdentifyBacklash(Synthetic(2.66, 5e-5, 60, true), {});
  const Estimate play = result.Find("backlash_deg")->estimate;
  const Estimate compliance = result.Find("contact_compliance_deg_Nm")->estimate;
  EXPECT_TRUE(play.Covers(2.66)) << play.value << " +- " << play.half_width_95;
  EXPECT_LT(play.half_width_95, 0.005);
  EXPECT_NEAR(compliance.value, 5e-5 / kDegree, 3.0 * compliance.half_width_95);
  EXPECT_EQ(play.trials, 60);
}

TEST(Backlash, ExtremesAreWiderThanTheContacts) {
  // The published way: noisy counts and bent teeth widen it.
  const Result result = IdentifyBacklash(Synthetic(2.66, 5e-5, 20, true), {});
  EXPECT_GT(result.Find("backlash_extremes_deg")->estimate.value, 2.68);
}

TEST(Backlash, WhatHeldTheLinkBeforeIsNoTrial) {
  Recording rows(48);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].time_s = static_cast<double>(i) / 240.0;
    rows[i].motor_current_A = -0.9;
  }
  for (Row row : Synthetic(2.66, 5e-5, 20, true)) {
    row.time_s += 0.2;
    rows.push_back(row);
  }
  const Estimate play = IdentifyBacklash(rows, {}).Find("backlash_deg")->estimate;
  EXPECT_EQ(play.trials, 20);
  EXPECT_NEAR(play.value, 2.66, 0.005);
}

TEST(Backlash, AGearWithoutPlayHasNone) {
  const Result result = IdentifyBacklash(Synthetic(0.0, 0.0, 20, true), {});
  EXPECT_NEAR(result.Find("backlash_deg")->estimate.value, 0.0, 0.01);
}

TEST(Backlash, OneTorqueOnlyOrTooFewPeriodsAreRefused) {
  EXPECT_THROW((void)IdentifyBacklash(Synthetic(2.66, 5e-5, 10, false), {}), std::invalid_argument);
  EXPECT_THROW((void)IdentifyBacklash(Synthetic(2.66, 5e-5, 3, true), {}), std::invalid_argument);
  EXPECT_THROW((void)IdentifyBacklash({}, {}), std::invalid_argument);
}

TEST(Backlash, TheProtocolPushesBothWaysOverThePublishedPeriod) {
  BacklashProtocol protocol({.trials = 1});
  EXPECT_GT(protocol.Step({.time_s = 0.1}).motor_torque_Nm, 0.0);
  EXPECT_NEAR(protocol.Step({.time_s = 1.3}).motor_torque_Nm, -0.02, 1e-12);
  // A hand that opposes: pressed down when the link is up.
  EXPECT_GT(protocol.Step({.time_s = 1.4, .output_angle_rad = 0.02}).hand_force_N, 0.0);
  (void)protocol.Step({.time_s = 2.6});
  EXPECT_TRUE(protocol.done());
}

}  // namespace
}  // namespace sinew::experiment
