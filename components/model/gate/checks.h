// The checks behind the rules; each gives its statistics, gate.cc compares them with the limits.
#pragma once

#include <vector>

#include "components/model/gate/channels.h"
#include "components/model/gate/gate.h"

namespace sinew::gate {

std::vector<Measurement> CheckConstants(const actuator::JointModel& model);
// Stamps, non-finite values, constant and duplicated channels.
std::vector<Measurement> CheckStructure(const std::vector<types::Run>& runs,
                                        const actuator::JointModel& model);
// A channel in other units in one of several recordings.
std::vector<Measurement> CheckRecordings(const std::vector<types::Run>& runs);
// The following expect rising stamps and finite values.
std::vector<Measurement> CheckWrapped(const types::Run& run);
// Registers whose sign bit was read as a part of the number.
std::vector<Measurement> CheckRegisters(const types::Run& run);

struct SpikeCheck {
  std::vector<Measurement> measured;  // of what stays in the recording
  std::vector<LeftOut> left_out;      // `run` is 0
  std::vector<Finding> findings;
};
// leave_out: a few rows of a channel are left out; false: they are measured like many.
SpikeCheck CheckSpikes(const types::Run& run, bool leave_out);
std::vector<Measurement> CheckFrozen(const types::Run& run, const actuator::JointModel& model);
std::vector<Measurement> CheckKinematics(const types::Run& run, const actuator::JointModel& model);
std::vector<Measurement> CheckBalance(const std::vector<types::Run>& runs,
                                      const actuator::JointModel& model);

// Rate, jitter, lost and interpolated rows. runs: at least one.
std::vector<Finding> FindSampling(const std::vector<types::Run>& runs);
// Saturation, resolution, constant channels, lags. runs: at least one.
std::vector<Finding> FindChannels(const std::vector<types::Run>& runs,
                                  const actuator::JointModel& model);

}  // namespace sinew::gate
