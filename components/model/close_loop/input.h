// Model, mappings and recordings that options name.
#pragma once

#include <filesystem>
#include <vector>

#include "components/model/close_loop/close_loop.h"

namespace sinew::close_loop {

struct Input {
  actuator::ModelFile model;
  std::filesystem::path model_path, map, held_out_map;
};

// The rig's where the options name none. Throws UsageError.
Input LoadInput(const Options& options);

// Recordings of one joint, FILE or FILE@START:END; mcap files need no mapping. Throws UsageError,
// also for a recording without an angle.
std::vector<types::Run> ReadJoint(const std::vector<std::filesystem::path>& files,
                                  const std::filesystem::path& map, int joint);

std::vector<report::Recording> Described(const std::vector<types::Run>& runs);

// The data gate with the options' accepted faults. Throws std::invalid_argument.
gate::GateReport AskGate(const Options& options, const std::vector<types::Run>& runs,
                         const actuator::JointModel& joint);

}  // namespace sinew::close_loop
