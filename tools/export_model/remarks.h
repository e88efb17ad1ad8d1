// Remarks of an exported model on itself: where it comes from, what the format does not carry and
// what that costs. Pure; allocates.
#pragma once

#include <string>
#include <vector>

#include "tools/export_model/cost.h"
#include "tools/export_model/described_robot.h"
#include "tools/export_model/write_model.h"

namespace sinew::export_model {

// base: with all that is fixed to it. source: the model file's name; costs: of `dropped`;
// recordings: names of the held-out ones, empty: none was given, and costs are empty.
Remarks MakeRemarks(Format format, const actuator::RobotModel& robot, const arm::Base& base,
                    const std::string& source, const std::vector<Dropped>& dropped,
                    const Costs& costs, const std::string& recordings);

}  // namespace sinew::export_model
