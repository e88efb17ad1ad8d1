// One squat of a recording as a row of pictures of the robot.
#pragma once

#include <filesystem>

#include "components/model/report/picture.h"
#include "sim/render/camera.h"

namespace sinew::squat_test {

inline constexpr int kPhotographs = 5;  // from standing to standing at equal times

// The first squat of the recording, seen from `view`; title and caption are the caller's. Draws
// folder/frame_00000.png and so on, which the picture's script reads: they are there until it is
// drawn. Throws UsageError (ReadPoses, LoadScene, Film), std::runtime_error (no OpenGL).
report::Picture PhotographSquat(const std::filesystem::path& recording,
                                const std::filesystem::path& urdf,
                                const std::filesystem::path& folder, render::View view);

}  // namespace sinew::squat_test
