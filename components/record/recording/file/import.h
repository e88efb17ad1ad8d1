// CSV files or bags of ROS 2 and a mapping in, one recording out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "components/record/recording/run_import.h"

namespace sinew::recording {

struct ImportResult {
  std::size_t runs = 0;
  std::uint64_t samples = 0;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::vector<std::string> notes;  // what of the files is not in the recording
};

// Every file becomes a session of its own, with all joints of the mapping. `map` may be empty for
// bags (MapOfRosBag). The recording is written as a whole or not at all. `progress` receives
// (samples done, samples of all files), if given. Throws UsageError.
ImportResult ImportFiles(const std::vector<std::filesystem::path>& paths,
                         const std::filesystem::path& map, const std::filesystem::path& out,
                         const FindSchema& find_schema,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace sinew::recording
