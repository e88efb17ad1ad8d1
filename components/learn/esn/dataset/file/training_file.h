// Plan of a training: schema sinew-esn-train/1, described in docs/formats_esn.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/learn/esn/dataset/dataset.h"
#include "components/learn/esn/training.h"

namespace sinew::esn {

inline constexpr char kTrainSchema[] = "sinew-esn-train/1";

struct NetworkPlan {
  std::string name;
  bool all_joints = false;  // inputs and targets of every joint of the model, MakeRobotDataset
  DatasetConfig dataset;
  TrainingConfig training;
};

struct TrainingPlan {
  double rate_Hz = 240.0;
  std::vector<NetworkPlan> networks;
};
void Describe(config::Fields& f, TrainingPlan& c);

// The plan of a network. Throws UsageError: file, line, key, expected; for a network that is not
// there it names those that are.
NetworkPlan LoadNetworkPlan(const std::filesystem::path& path, const std::string& network);

}  // namespace sinew::esn
