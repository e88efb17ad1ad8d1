// The rig's surrogate with a guard that bears the pauses of a busy machine: for tests that ask what
// follows on what, not how fast (that is the guard's own test).
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "components/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {

// Path of the configuration, in the folder.
inline std::string PatientConfig(const TemporaryFolder& folder) {
  std::string text = config::ReadFile(SINEW_SOURCE_DIR "/robots/rig/surrogate.yaml");
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"missed_periods: 3", "missed_periods: 100"},
        {"fault_after_ms: 60", "fault_after_ms: 3000"}}) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return folder.Write("surrogate.yaml", text);
}

}  // namespace sinew::testing
