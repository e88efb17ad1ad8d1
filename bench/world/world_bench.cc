// How fast a biped with twelve joints stands on the ground in simulation, beside the same step with
// DART's dynamics and beside MuJoCo; and how long the inverse dynamics of a biped on both soles
// takes.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target
//   world_bench build/release/bin/world_bench
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "bench/floating_world/floating_world.h"
#include "bench/world/mujoco_world.h"
#include "sim/world/contact.h"
#include "sim/world/floating_chain.h"
#include "tests/components/bodies/stance/biped.h"
#include "tests/sim/world/biped.h"
#include "tests/sim/world/dart_skeleton.h"
#include "tests/sim/world/robot.h"

namespace sinew::world {
namespace {

constexpr int kStepsPerIteration = 100;

bool HasBiped(benchmark::State& state) {
  if (std::filesystem::exists(BipedPath(kBerkeleyBiped))) return true;
  state.SkipWithError("the biped of ../shared is not here");
  return false;
}

// iteration_s: simulated time of one. simulated_s_per_s: the real-time factor. weight_share: what
// the feet carry at the end over the weight, 1 when the robot stands.
void Report(benchmark::State& state, double iteration_s, double normal_N, double mass_kg) {
  const double simulated_s = static_cast<double>(state.iterations()) * iteration_s;
  state.counters["simulated_s_per_s"] =
      benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  state.counters["weight_share"] = normal_N / (9.81 * mass_kg);
}

void Standing(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  FloatingWorld world(biped.config);
  world.Reset(biped.state);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(world.chain().joint_count());
  for (auto _ : state) {
    for (int k = 0; k < kStepsPerIteration; ++k) {
      HoldPosture(biped, world.state(), &torque);
      if (world.Step(torque) != StepStatus::kOk) state.SkipWithError("the simulation failed");
    }
  }
  double normal_N = 0.0;
  for (const ContactForce& force : world.contact_forces()) normal_N += force.normal_N;
  Report(state, kStepsPerIteration * world.substep_s(), normal_N, world.chain().mass_kg());
}
BENCHMARK(Standing)->Unit(benchmark::kMillisecond);

// robots/biped with drives, rotors, friction and elastic toes in position mode, in cycles of 2 ms.
void StandingRobot(benchmark::State& state) {
  constexpr double kCycle_s = 2e-3;
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  provider::PlantSensors sensors;
  for (auto _ : state) {
    robot.Step(command, kCycle_s, &sensors);
    if (sensors.fault) state.SkipWithError("the simulation failed");
  }
  double normal_N = 0.0;
  for (const double force_N : robot.body_sensors()->foot_force_N) normal_N += force_N;
  Report(state, kCycle_s, normal_N, robot.chain().mass_kg());
}
BENCHMARK(StandingRobot)->Unit(benchmark::kMillisecond);

// FloatingWorld's step (drift, explicit midpoint kick, drift; the same law of contact) with DART's
// kinematics and articulated-body algorithm.
class DartWorld {
 public:
  explicit DartWorld(const StandingBiped& biped)
      : chain_(biped.config.chain, /*fixed_base=*/false),
        ground_(biped.config.ground),
        state_(biped.state),
        memory_(biped.config.contacts.size()),
        forces_(biped.config.contacts.size()),
        substep_s_(biped.config.substep_s) {
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      forces_[i].body = biped.config.contacts[i].body;
      forces_[i].point_m = biped.config.contacts[i].point_m;
    }
    next_memory_ = memory_;
    acceleration_ = Eigen::VectorXd::Zero(state_.velocity.size());
  }

  void Step(const Eigen::VectorXd& torque_Nm) {
    middle_ = state_;
    Drift(0.5 * substep_s_, &middle_);
    Accelerate(torque_Nm);
    middle_.velocity += 0.5 * substep_s_ * acceleration_;
    Accelerate(torque_Nm);
    middle_.velocity = state_.velocity + substep_s_ * acceleration_;
    Drift(0.5 * substep_s_, &middle_);
    std::swap(state_, middle_);
    std::swap(memory_, next_memory_);
  }

  const FloatingState& state() const { return state_; }
  double normal_N() const {
    double sum = 0.0;
    for (const LinkForce& force : forces_) sum += force.force_N.z();
    return sum;
  }

 private:
  void Accelerate(const Eigen::VectorXd& torque_Nm) {
    chain_.SetState(middle_);
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      const dart::dynamics::BodyNode* node =
          chain_.skeleton()->getBodyNode(static_cast<std::size_t>(forces_[i].body + 1));
      const GroundLaw::Result result =
          ground_.Force(node->getTransform() * forces_[i].point_m,
                        node->getLinearVelocity(forces_[i].point_m), memory_[i]);
      next_memory_[i] = result.memory;
      forces_[i].force_N << result.force.tangential_N, result.force.normal_N;
    }
    chain_.Solve(torque_Nm, forces_, acceleration_);
  }

  DartChain chain_;
  GroundLaw ground_;
  FloatingState state_, middle_;
  std::vector<ContactMemory> memory_, next_memory_;
  std::vector<LinkForce> forces_;
  Eigen::VectorXd acceleration_;
  double substep_s_;
};

void StandingWithDart(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  DartWorld world(biped);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(biped.posture_rad.size());
  for (auto _ : state) {
    for (int k = 0; k < kStepsPerIteration; ++k) {
      HoldPosture(biped, world.state(), &torque);
      world.Step(torque);
    }
  }
  Report(state, kStepsPerIteration * biped.config.substep_s, world.normal_N(),
         FloatingChain(biped.config.chain).mass_kg());
}
BENCHMARK(StandingWithDart)->Unit(benchmark::kMillisecond);

void StandingWithMujoco(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  MujocoWorld world(biped.config);
  world.Reset(biped.state);
  const double mass_kg = FloatingChain(biped.config.chain).mass_kg();
  if (std::abs(world.mass_kg() - mass_kg) > 1e-9 * mass_kg) {
    state.SkipWithError("MuJoCo's model has another mass");
    return;
  }
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(world.joint_count());
  for (auto _ : state) {
    for (int k = 0; k < kStepsPerIteration; ++k) {
      HoldPosture(biped, world.state(), &torque);
      world.Step(torque);
    }
  }
  Report(state, biped.config.substep_s, world.normal_N(), world.mass_kg());
}
BENCHMARK(StandingWithMujoco)->Unit(benchmark::kMillisecond);

// Accelerations alone: state set, equations solved.
void Solve(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  FloatingChain chain(biped.config.chain);
  const Eigen::VectorXd torque = Eigen::VectorXd::Zero(chain.joint_count());
  Eigen::VectorXd acceleration(chain.freedom());
  for (auto _ : state) {
    chain.SetState(biped.state);
    chain.Solve(torque, {}, acceleration);
    benchmark::DoNotOptimize(acceleration.data());
  }
}
BENCHMARK(Solve)->Unit(benchmark::kMicrosecond);

void SolveWithDart(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  DartChain chain(biped.config.chain, /*fixed_base=*/false);
  const Eigen::VectorXd torque = Eigen::VectorXd::Zero(biped.posture_rad.size());
  Eigen::VectorXd acceleration(biped.state.velocity.size());
  for (auto _ : state) {
    chain.SetState(biped.state);
    chain.Solve(torque, {}, acceleration);
    benchmark::DoNotOptimize(acceleration.data());
  }
}
BENCHMARK(SolveWithDart)->Unit(benchmark::kMicrosecond);

// Inverse dynamics of robots/biped on both soles: what the stand-in of the networks does in a tick.
void SolveDoubleSupport(benchmark::State& state) {
  const arm::Chain chain = stance::ReadNuBiped();
  stance::DoubleSupport stance(chain);
  const leg::LegGeometry geometry = leg::GeometryOf(chain, leg::NamesOfSide("left"), "left_sole");
  const stance::JointsMotion motion = stance::Squat(
      stance.dynamics(), geometry, {leg::StraightHeight(geometry, 0.0) - 0.2, 0.1, 1.0});
  for (auto _ : state) {
    benchmark::DoNotOptimize(stance.Solve(motion.q, motion.v, motion.a).torque.data());
  }
}
BENCHMARK(SolveDoubleSupport)->Unit(benchmark::kMicrosecond);

void SolveWithMujoco(benchmark::State& state) {
  if (!HasBiped(state)) return;
  const StandingBiped biped = MakeStandingBiped();
  MujocoWorld world(biped.config);
  world.Reset(biped.state);
  for (auto _ : state) {
    world.Solve();
    benchmark::DoNotOptimize(*world.acceleration());
  }
}
BENCHMARK(SolveWithMujoco)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sinew::world

BENCHMARK_MAIN();
