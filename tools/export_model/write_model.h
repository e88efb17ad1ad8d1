// A described robot as text of another simulator's format.
//
// Every file begins with comments: what was dropped, and what dropping it costs. Bodies and joints
// only: no shapes but in a URDF, which keeps those of the model's own. Pure; allocates.
#pragma once

#include <string>
#include <vector>

#include "tools/export_model/cost.h"
#include "tools/export_model/described_robot.h"

namespace sinew::export_model {

// One line each, for the head of the file. Of "--", which XML comments may not contain, the second
// dash is left out.
using Remarks = std::vector<std::string>;

// Source of the model, what the format does not carry and what that costs (remarks.cc).
// base: with all that is fixed to it. source: the model file's name; costs: of `dropped`;
// recordings: names of the held-out ones, empty: none was given, and costs are empty.
Remarks MakeRemarks(Format format, const actuator::RobotModel& robot, const arm::Base& base,
                    const std::string& source, const std::vector<Dropped>& dropped,
                    const Costs& costs, const std::string& recordings);

// MuJoCo 2.2 XML, angles in radians. Links on fixed joints are sites of the body that carries them.
// A drive is a motor: control is the torque at its shaft, N m, within its limit; where the model
// has a servo, control is the set point, rad or m. Joints that mimic others are equalities.
std::string WriteMjcf(const DescribedRobot& robot, const Remarks& remarks);

// SDF 1.9, of robots with joints that mimic others 1.11, which has these. Links on fixed joints are
// frames of the link that carries them; a fixed base is fixed to the world.
std::string WriteSdf(const DescribedRobot& robot, const Remarks& remarks);

// The URDF of the model, its shapes and comments kept: `dynamics` and the limit's effort of every
// joint of the model, inertial of the links that the model changes, DefineMaterials. A joint with
// the limits 0 and 0, which other readers lock, is continuous; a prismatic one has -1e16 and 1e16,
// as far as SDF counts. Throws UsageError for
// what is no XML, std::invalid_argument for a joint that it lacks.
std::string WriteUrdf(const DescribedRobot& robot, const std::string& urdf, const Remarks& remarks);

}  // namespace sinew::export_model
