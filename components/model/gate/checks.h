// The checks behind the rules; each gives its statistics, gate.cc compares them with the limits.
#pragma once

#include <vector>

#include "components/model/gate/channels.h"
#include "components/model/gate/gate.h"

namespace sinew::gate {

std::vector<Measurement> CheckConstants(const std::vector<types::Run>& runs,
                                        const actuator::JointModel& model);
// Stamps, non-finite values, constant and duplicated channels.
std::vector<Measurement> CheckStructure(const std::vector<types::Run>& runs,
                                        const actuator::JointModel& model);
// A channel in other units in one of several recordings.
std::vector<Measurement> CheckRecordings(const std::vector<types::Run>& runs);
// The following expect rising stamps and finite values.
std::vector<Measurement> CheckWrapped(const types::Run& run);
std::vector<Measurement> CheckSpikes(const types::Run& run);
std::vector<Measurement> CheckFrozen(const types::Run& run, const actuator::JointModel& model);
std::vector<Measurement> CheckKinematics(const types::Run& run, const actuator::JointModel& model);
std::vector<Measurement> CheckBalance(const std::vector<types::Run>& runs,
                                      const actuator::JointModel& model);

std::vector<identify::Finding> FindFindings(const std::vector<types::Run>& runs,
                                            const actuator::JointModel& model);

}  // namespace sinew::gate
