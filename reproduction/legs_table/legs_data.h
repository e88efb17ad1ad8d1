// The biped's chirp squat as training data of table 6.5.
#pragma once

#include <filesystem>
#include <vector>

#include "reproduction/legs_table/legs_table.h"

namespace sinew::reproduction {

struct LegsRecording {
  std::filesystem::path robot;     // robots/biped
  std::filesystem::path folder;    // of the recording
  std::filesystem::path programs;  // of the participants; empty: that of this program
  int domain_id = 0;
  double duration_s = 210.0;  // of the session; the published chirp takes 200 s
};

// Records the squat with the real processes, by the drives' position loops, at 240 Hz in lockstep;
// a recording that is there is kept. Throws UsageError, std::runtime_error.
std::filesystem::path RecordChirp(const LegsRecording& options);

// All twelve joints, then the six pitch joints. Throws UsageError naming the file.
std::vector<LegsData> ReadLegsData(const std::filesystem::path& recording,
                                   const std::filesystem::path& robot);

}  // namespace sinew::reproduction
