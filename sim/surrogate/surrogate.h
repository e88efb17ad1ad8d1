// The surrogate as a state provider's plant: one joint of the rig behind the topics.
//
// Commands are at the output (position, velocity) or at the motor shaft (torque), as everywhere;
// the drive gets them at the motor shaft. A command with a value that is not finite is not
// executed: the drive idles for that cycle and the sensors say so (fault). Angles and forces beyond
// any sense are limited. One owner; Step does not allocate while commands are finite.
#pragma once

#include <cstdint>
#include <memory>

#include "components/provider/plant.h"
#include "sim/surrogate/rig.h"

namespace sinew::surrogate {

class Surrogate : public provider::Plant {
 public:
  explicit Surrogate(const RigParameters& parameters);  // throws std::invalid_argument

  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override;
  void Reset(provider::PlantSensors* sensors) override;
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;

  const Rig& rig() const { return rig_; }
  Rig& rig() { return rig_; }
  std::uint64_t refused_commands() const { return refused_commands_; }

 private:
  static void Fill(const RigReading& reading, double age_s, provider::PlantSensors* sensors);

  Rig rig_;
  std::uint64_t refused_commands_ = 0;
};

}  // namespace sinew::surrogate
