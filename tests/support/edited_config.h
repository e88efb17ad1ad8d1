// A configuration of the rig with places replaced: for tests that need it nearly as it is shipped.
// Throws std::runtime_error naming the text that is not there, so that a changed file is noticed.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/base/config/config.h"

namespace sinew::testing {

using Edits = std::vector<std::pair<std::string, std::string>>;  // what, by what

// Each at its first occurrence, in turn.
inline std::string Edited(std::string text, const Edits& edits) {
  for (const auto& [what, by] : edits) {
    const std::size_t at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("no '" + what + "' in\n" + text);
    text.replace(at, what.size(), by);
  }
  return text;
}

// Of a file of robots/rig.
inline std::string EditedRigConfig(const std::string& file, const Edits& edits) {
  return Edited(config::ReadFile(SINEW_SOURCE_DIR "/robots/rig/" + file), edits);
}

// The same on a bus of that path.
inline std::string RigConfigOnBus(const std::string& file, const std::string& bus,
                                  Edits edits = {}) {
  edits.emplace_back("transport: virtual", "transport: virtual\n    bus: " + bus);
  return EditedRigConfig(file, edits);
}

}  // namespace sinew::testing
