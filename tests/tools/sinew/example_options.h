// close-loop's options for one of the example recordings of our rig: clean or one_effect.
#pragma once

#include <filesystem>
#include <string>

#include "tools/sinew/close_loop.h"

namespace sinew::tools {

inline CloseLoopOptions ExampleOptions(const std::string& example) {
  const std::filesystem::path source = SINEW_SOURCE_DIR;
  const std::filesystem::path folder = source / "tests" / "data" / "rig_examples" / example;
  CloseLoopOptions options;
  options.model = folder / "rig.json";
  options.map = source / "robots" / "rig" / "csv_map.yaml";
  options.train = {folder / "train_1.csv", folder / "train_2.csv", folder / "train_3.csv"};
  options.held_out = {folder / "sealed.csv"};
  return options;
}

}  // namespace sinew::tools
