// The rig's surrogate with a guard that bears the pauses of a busy machine: for tests that ask what
// follows on what, not how fast (that is the guard's own test).
#pragma once

#include <string>

#include "tests/support/edited_config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {

// Path of the configuration, in the folder.
inline std::string PatientSurrogate(const TemporaryFolder& folder) {
  return folder.Write(
      "surrogate.yaml",
      EditedRigConfig("surrogate.yaml", {{"missed_periods: 3", "missed_periods: 100"},
                                         {"fault_after_ms: 60", "fault_after_ms: 3000"}}));
}

}  // namespace sinew::testing
