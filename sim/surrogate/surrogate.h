// The surrogate as a state provider's plant: one joint of the rig behind the topics, or several
// rigs side by side that know nothing of each other.
//
// Commands are at the output (position, velocity) or at the motor shaft (torque), as everywhere;
// the drive gets them at the motor shaft. A command or a disturbance with a value that is not
// finite is not executed: the drive idles for that cycle and the sensors report a fault. Angles,
// velocities, forces and payloads are limited (surrogate.cc). Limited ones can still be more than
// the integration bears (the largest force to and fro on an imposed pressure): a rig whose readings
// are not finite starts anew, and the sensors report a fault. One owner; Step does not allocate
// while commands are finite.
#pragma once

#include <cstdint>
#include <vector>

#include "components/robot/provider/simulated_plant.h"
#include "sim/surrogate/rig.h"

namespace sinew::surrogate {

class Surrogate : public provider::SimulatedPlant {
 public:
  // The second rig has the seed after the first's, and so on. Throws std::invalid_argument.
  explicit Surrogate(const RigParameters& parameters, int joints = 1);

  int joint_count() const override { return static_cast<int>(rigs_.size()); }
  std::uint32_t measured_flags() const override;
  void Reset(provider::PlantSensors* sensors) override;
  void Disturb(const provider::Disturbance& disturbance) override { disturbance_ = disturbance; }
  // A pressure that is not finite is not imposed; others are limited (surrogate.cc).
  void ImposePressure(const provider::ImposedPressure& pressure) override { pressure_ = pressure; }
  const provider::GearTruth& gear_truth() const override { return truth_; }
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;

  const Rig& rig(int joint = 0) const { return rigs_[static_cast<std::size_t>(joint)]; }
  Rig& rig(int joint = 0) { return rigs_[static_cast<std::size_t>(joint)]; }
  std::uint64_t refused_commands() const { return refused_commands_; }

 private:
  // False: a value was not finite, and the drive idles.
  bool StepRig(std::size_t joint, const provider::PlantCommand& command, double period_s,
               provider::PlantSensors* sensors, bool* diverged);
  // Reads the rig's sensors and its gear's true state.
  RigReading Read(std::size_t joint) noexcept;
  static void Fill(std::size_t joint, const RigReading& reading, double age_s,
                   provider::PlantSensors* sensors);

  std::vector<Rig> rigs_;
  provider::Disturbance disturbance_;
  provider::ImposedPressure pressure_;
  provider::GearTruth truth_;
  std::uint64_t refused_commands_ = 0;
};

}  // namespace sinew::surrogate
