// The cost of dropping a part of a joint's model on held-out recordings, the model with and without
// it compared:
//
// - a robot of one joint: the error of the simulated position beside the recordings, by sim/world
//   (tools/verify)
// - a robot of several joints on a fixed base: the error of the torque that each joint's drive
//   needs for the recorded motion, by the balance that `sinew close-loop` reports
//   (components/model/arm, without a term rigid_body components/model/identify). A joint driven by
//   effort beside others needs the whole robot simulated, which free_run does not do.
//
// The terms have their last fitted values, bodies are those of the URDF: nothing is fitted again.
// Pure but for the URDF that the simulation reads; allocates.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/run.h"
#include "components/bodies/links/bodies.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing.h"
#include "tools/export_model/described_robot.h"

namespace sinew::export_model {

enum class Measure { kSimulatedPosition, kPredictedTorque };
// "simulated_position", for programs.
std::string_view MeasureName(Measure measure);
// Unit of an error of a joint: rad or m, Nm or N.
std::string_view UnitOf(Measure measure, const actuator::RobotModel& robot,
                        const std::string& joint_name);

struct Cost {
  std::string joint;
  std::string effect;  // of Dropped; "all": everything of the joint that is dropped at once
  // Error, rms over the samples that both models reached: simulated less measured position, or
  // measured less needed torque at the output. Nothing: see why_not.
  std::optional<double> without, with;
  std::string why_not;
};

struct Costs {
  Measure measure = Measure::kSimulatedPosition;
  std::vector<Cost> of;
};

// One entry for each of `dropped`, in its order, and then "all" of each joint of which several are
// dropped, in the order of the joints.

// robot: of one joint; processing: resolved. Throws std::invalid_argument: more joints than one,
// recordings that cannot be used.
Costs CostsOf(const std::vector<Dropped>& dropped, const actuator::RobotModel& robot,
              const std::vector<types::Run>& runs, const identify::ProcessingOptions& processing,
              double horizon_s);

// Throws std::invalid_argument: a robot on a floating base, of whose joints no balance is known
// without the forces under its soles.
void RequireFixedBase(const actuator::RobotModel& robot);

// runs[j]: the recordings of joint j, in the same order for every joint. chain: the URDF, without
// the model's payloads. wished: what it leaves to the data is resolved by the recordings, of an arm
// by those of the first joint. Throws std::invalid_argument: a floating base, joints of an arm that
// the URDF lacks, recordings that cannot be used or do not fit together.
Costs TorqueCostsOf(const std::vector<Dropped>& dropped, const actuator::RobotModel& robot,
                    const arm::Chain& chain, const std::vector<std::vector<types::Run>>& runs,
                    const identify::ProcessingOptions& wished);

}  // namespace sinew::export_model
