// What to train and how: schema sinew-esn-train/1, described in docs/formats_esn.md.
//
//   schema: sinew-esn-train/1
//   rate_Hz: 240
//   networks:
//     - name: pea
//       target: drive_torque_Nm          # or load_torque_Nm
//       region: outside                  # inside, all
//       joints: one                      # or all: one network for the whole robot
//       inputs: [reference_position_rad, reference_velocity_rad_s, chamber_pressure_bar]
//       neurons: 78
//       ...
#pragma once

#include <filesystem>
#include <string>

#include "components/learn/esn/dataset/dataset.h"
#include "components/learn/esn/training.h"

namespace sinew::esn {

struct NetworkPlan {
  std::string name;
  bool all_joints = false;  // inputs and targets of every joint of the model, MakeRobotDataset
  DatasetConfig dataset;
  TrainingConfig training;
};

// The plan of a network. Throws UsageError: file, line, key, expected; for a network that is not
// there it names those that are.
NetworkPlan LoadNetworkPlan(const std::filesystem::path& path, const std::string& network);
NetworkPlan ParseNetworkPlan(const std::string& text, const std::string& name,
                             const std::string& network);

}  // namespace sinew::esn
