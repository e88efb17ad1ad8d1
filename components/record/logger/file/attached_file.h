// Files that a recording carries, so that it can be understood without the machine it came from.
#pragma once

#include <cstdint>
#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/mcap.h"

namespace sinew::logger {

// The largest file that is attached: models, configurations, weights; not recordings or meshes.
inline constexpr std::uintmax_t kLargestAttachment = config::kLargestText;

struct AttachedFile {
  std::string name;    // in the recording
  std::string sha256;  // of the file, as sha256sum prints it
  std::uintmax_t bytes = 0;
  bool attached = false;  // false: too large, only the hash is recorded
  recording::McapAttachment attachment;
};

// FILE, or NAME=FILE; without a name it is the file's own, without folders. Throws UsageError
// naming the file when it cannot be read.
AttachedFile ReadAttachedFile(const std::string& text);

}  // namespace sinew::logger
