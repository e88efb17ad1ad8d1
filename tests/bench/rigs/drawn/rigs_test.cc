// Physics of drawn rigs: energy, gravity at standstill, teeth, stiction, gas.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "bench/rigs/drawn/cases.h"
#include "bench/rigs/drawn/gas.h"
#include "bench/rigs/drawn/plant.h"
#include "bench/rigs/drawn/sensors.h"

namespace sinew::rigs {
namespace {

// A pendulum on a motor that gives nothing.
Rig Pendulum() {
  Rig rig;
  rig.family = Family::kDirectDrive;
  rig.coupling = Coupling::kRigid;
  rig.gear_ratio = 1.0;
  rig.efficiency = 1.0;
  rig.current_limit_A = 0.0;
  rig.motor_viscous = rig.link_viscous = rig.coulomb = 0.0;
  rig.centre = 0.0;
  rig.rows = 2000;
  rig.rate_Hz = 200.0;
  rig.steps_per_row = 50;
  return rig;
}

Rig FirstOf(Family family, std::uint64_t from = 1) {
  for (std::uint64_t number = from;; ++number) {
    Rig rig = DrawRig(number);
    if (rig.family == family) return rig;
  }
}

TEST(Rigs, FrictionlessPendulumKeepsItsEnergy) {
  const Rig rig = Pendulum();
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kTask, 0));
  double lowest = 1e9, highest = -1e9, swing = 0.0;
  for (const TrueRow& row : rows) {
    const double energy = 0.5 * rig.total_inertia() * row.velocity * row.velocity +
                          rig.gravity_torque * std::sin(row.true_position);
    lowest = std::min(lowest, energy);
    highest = std::max(highest, energy);
    swing = std::max(swing, std::abs(row.true_position));
  }
  EXPECT_GT(swing, 3.0);
  // Semi-implicit steps: energy swings by the step's length and does not drift.
  EXPECT_LT(highest - lowest, 2e-3 * rig.gravity_torque);
}

TEST(Rigs, FrictionAboveGravityHoldsTheJointStill) {
  Rig rig = Pendulum();
  rig.coulomb = 1.5 * rig.gravity_torque;
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kTask, 0));
  EXPECT_LT(std::abs(rows.back().true_position - rows[100].true_position), 1e-9);
  EXPECT_LT(std::abs(rows.back().true_position), 2.0 * rig.bristle);
}

TEST(Rigs, CurrentAtStandstillCoversGravityUpToFriction) {
  const Rig rig = FirstOf(Family::kHarmonic);
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kDesigned, 0));
  int still = 0;
  for (std::size_t i = 20; i + 20 < rows.size(); ++i) {
    bool rest = true;
    for (std::size_t k = i - 20; k <= i + 20; ++k)
      rest = rest && std::abs(rows[k].velocity) < 1e-3 * rig.speed();
    if (!rest) continue;
    ++still;
    const double weight = rig.gravity_torque * std::cos(rows[i].true_position);
    EXPECT_LE(std::abs(rows[i].tooth_force - weight), 1.05 * rig.coulomb + 1e-3 * weight);
  }
  EXPECT_GT(still, 20);
}

TEST(Rigs, TeethTransmitNothingInsideThePlayAndNeverPull) {
  const Rig rig = FirstOf(Family::kSeaPea);
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kDesigned, 0));
  int apart = 0, pressed = 0;
  for (const TrueRow& row : rows) {
    const double gap = row.motor - row.true_position;
    if (std::abs(gap) < 0.5 * rig.play * 0.999) {
      // One step lies between the force and the angles of a row.
      const double step = 2.0 * std::abs(row.motor_velocity - row.velocity) * rig.step_s();
      if (std::abs(gap) + step < 0.5 * rig.play) {
        EXPECT_EQ(row.tooth_force, 0.0);
        ++apart;
      }
    } else {
      ++pressed;
      EXPECT_GE(row.tooth_force * gap, 0.0);
    }
  }
  EXPECT_GT(apart, 10);
  EXPECT_GT(pressed, 1000);
}

TEST(Rigs, ClosedChamberKeepsItsMassAndLiesBetweenIsothermalAndAdiabatic) {
  Rig rig;
  rig.pneumatic_slope = 10.0;
  rig.gas_volume_m3 = 1e-4;
  rig.gas_wall_time_s = 0.05;
  for (const double duration_s : {1e-3, 50.0}) {
    Gas gas(rig, 0.0, 3.0);
    const double mass = gas.mass_kg();
    const int steps = 20000;
    const double end = -0.5;  // a half of the volume's change: V falls by 5e-5
    for (int i = 1; i <= steps; ++i) gas.Step(end * i / steps, 0.0, false, duration_s / steps);
    const double ratio = (gas.gauge_bar() + 1.01325) / (3.0 + 1.01325);
    EXPECT_DOUBLE_EQ(gas.mass_kg(), mass);
    const double isothermal = 2.0, adiabatic = std::pow(2.0, 1.4);
    EXPECT_NEAR(ratio, duration_s > 1.0 ? isothermal : adiabatic, 0.02);
  }
}

TEST(Rigs, TeethOfAHangingRigChangeSides) {
  const Rig rig = FirstOf(Family::kHanging, kSecondDraw);
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kDesigned, 0));
  double one = 0.0, other = 0.0;
  for (const TrueRow& row : rows) (row.tooth_force > 0.0 ? one : other) += 1.0;
  EXPECT_GT(std::min(one, other), 0.1 * static_cast<double>(rows.size()));
}

TEST(Rigs, TasksOfTheSecondDrawAreOfThreeKinds) {
  std::set<std::string> kinds;
  for (std::uint64_t number = kSecondDraw; number < kSecondDraw + 30; ++number) {
    const Rig rig = DrawRig(number);
    for (int recording = 0; recording < kRecordings; ++recording) {
      const Motion motion(rig, Excitation::kTask, recording);
      const double step = 0.01 / rig.frequency_Hz;
      int still = 0, all = 0;
      std::set<long> stops;
      for (double t = step; t < motion.duration_s(); t += step, ++all) {
        const double before = motion.Reference(t - step), now = motion.Reference(t);
        EXPECT_LE(std::abs(now - rig.centre), 1.01 * rig.amplitude) << number;
        if (before != now) continue;
        ++still;
        stops.insert(std::lround(1e3 * (now - rig.centre) / rig.amplitude));
      }
      kinds.insert(still == 0 ? "sine" : stops.size() > 2 ? "places" : "strokes");
      EXPECT_LT(still, 0.9 * all) << number;
    }
  }
  EXPECT_EQ(kinds.size(), 3u);
}

TEST(Rigs, DrawnRigsStayWithinTheirRangesAndCoverEveryFamily) {
  std::set<Family> families[3];
  for (std::uint64_t k = 1; k <= 600; ++k) {
    const std::uint64_t number = k <= 200 ? k : k <= 400 ? kSecondDraw + k : kThirdDraw + k;
    const Rig rig = DrawRig(number);
    families[k <= 200 ? 0 : k <= 400 ? 1 : 2].insert(rig.family);
    EXPECT_GE(rig.rate_Hz, 50.0);
    EXPECT_LE(rig.rate_Hz, 1000.0);
    EXPECT_GE(rig.steps_per_row, 10);
    EXPECT_LE(rig.rows, 40000);
    EXPECT_GE(rig.rows / rig.rate_Hz, 9.9);
    EXPECT_LE(rig.rows / rig.rate_Hz, 300.0);
    EXPECT_GE(rig.pole_pairs, 5);
    EXPECT_LE(rig.pole_pairs, 21);
    EXPECT_TRUE(std::isfinite(rig.force_scale()) && rig.force_scale() > 0.0) << number;
    EXPECT_GE(DrawCases(rig).size(), 6u);
    for (const Case& c : DrawCases(rig)) {
      for (const std::string& name : c.effects) EXPECT_NO_THROW(FindEffect(name));
    }
  }
  EXPECT_EQ(families[0].size(), 6u);
  EXPECT_EQ(families[1].size(), 7u);
  EXPECT_EQ(families[2].size(), 3u);
  for (const Family family : families[2]) EXPECT_FALSE(families[1].contains(family));
}

TEST(Rigs, ABeltIsStifferTheHarderItPulls) {
  const Rig rig = FirstOf(Family::kBelt, kThirdDraw);
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kDesigned, 0));
  double soft = 0.0,
         hard = 0.0;  // largest stiffness of small, least of large loads, at slow motion
  for (const TrueRow& row : rows) {
    if (std::abs(row.motor_velocity - row.velocity) * rig.damping > 1e-3 * rig.force_scale())
      continue;
    const double load = std::abs(row.tooth_force) / rig.force_scale();
    const double stiffness = row.tooth_force / (row.motor - row.true_position);
    if (load > 0.1 && load < 0.2) soft = std::max(soft, stiffness);
    if (load > 0.8) hard = hard == 0.0 ? stiffness : std::min(hard, stiffness);
  }
  EXPECT_GT(soft, 0.0);
  EXPECT_GT(hard, soft);
}

TEST(Rigs, AQuasiDirectDriveIsHomedAnewForEveryRecording) {
  const Rig rig = FirstOf(Family::kQuasiDirect, kThirdDraw);
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kTask, 0));
  double zeros[2] = {};
  for (int recording = 0; recording < 2; ++recording) {
    const auto readings = ReadWithNoise(rig, rows, recording);
    for (const Reading& r : readings) {
      zeros[recording] += r.position - rows[static_cast<std::size_t>(r.index)].position;
    }
    zeros[recording] /= static_cast<double>(readings.size());
  }
  EXPECT_GT(std::abs(zeros[0] - zeros[1]), 1e-2 * rig.homing);
  EXPECT_LT(std::abs(zeros[0]), 5.0 * rig.homing);
}

TEST(Rigs, EveryEffectOfARigChangesItsRecordings) {
  for (const Family family : {Family::kSeaPea, Family::kDirectDrive, Family::kServo}) {
    Rig rig = FirstOf(family);
    rig.rows = std::min(rig.rows, static_cast<int>(20.0 * rig.rate_Hz));
    const Motion motion(rig, Excitation::kDesigned, 1);
    const auto twin = ReadExactly(rig, Simulate(rig, {}, motion));
    for (const Kind kind : {Kind::kCatalogue, Kind::kOutside, Kind::kIgnorance}) {
      for (const std::string& name : EffectsOf(rig, kind)) {
        Effect effect = DrawEffect(rig, name);
        effect.size *= 30.0;
        const auto rows = ReadExactly(rig, Simulate(rig, {effect}, motion));
        double change = 0.0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
          EXPECT_TRUE(std::isfinite(rows[i].drive)) << name;
          change = std::max({change, std::abs(rows[i].drive - twin[i].drive),
                             std::abs(rows[i].position - twin[i].position),
                             std::abs(rows[i].pressure_bar - twin[i].pressure_bar),
                             std::abs(rows[i].load_force_N - twin[i].load_force_N)});
        }
        EXPECT_GT(change, 0.0) << WordOf(family) << " " << name;
      }
    }
  }
}

TEST(Rigs, UnknownEffectsAndFaultsAreRefused) {
  const Rig rig = Pendulum();
  EXPECT_THROW(Simulate(rig, {{"no_such_effect", 1.0, {}}}, Motion(rig, Excitation::kTask, 0)),
               std::invalid_argument);
  std::vector<std::vector<Reading>> recordings(1, std::vector<Reading>(10));
  EXPECT_THROW(PlantFault(rig, "no_such_fault", recordings), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::rigs
