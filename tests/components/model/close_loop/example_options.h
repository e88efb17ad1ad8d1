// Options for one of the example recordings of our rig: clean or one_effect.
#pragma once

#include <filesystem>
#include <string>

#include "components/model/close_loop/close_loop.h"
#include "sim/plant/joint_body.h"

namespace sinew::close_loop {

// With the rig's files and joints that move alone.
inline Options BasicOptions() {
  Options options;
  options.rig = std::filesystem::path(SINEW_SOURCE_DIR) / "robots" / "rig";
  options.body = plant::JointAlone();
  return options;
}

inline Options ExampleOptions(const std::string& example) {
  const std::filesystem::path source = SINEW_SOURCE_DIR;
  const std::filesystem::path folder = source / "tests" / "data" / "rig_examples" / example;
  Options options = BasicOptions();
  options.model = folder / "rig.json";
  options.map = source / "robots" / "rig" / "csv_map.yaml";
  options.train = {folder / "train_1.csv", folder / "train_2.csv", folder / "train_3.csv"};
  options.held_out = {folder / "sealed.csv"};
  return options;
}

}  // namespace sinew::close_loop
