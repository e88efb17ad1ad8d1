// A scene from a URDF: its bodies (components/bodies/links/file/urdf_file.h) and its visual
// elements.
//
// Drawn are box, cylinder and sphere, each with origin and material (rgba of the visual's own
// material, or of the robot's or another visual's of that name; alpha and textures are not used).
// Visuals that are meshes are counted and left out.
#pragma once

#include <filesystem>
#include <string>

#include "sim/render/scene.h"

namespace sinew::render {

// file_name stands for the file in messages. Throws UsageError, one line naming file and line, for
// a visual that is not as the format asks, for a robot without any shape to draw, and for what
// ParseUrdf refuses.
Scene ParseScene(const std::string& xml, const std::string& file_name);

// Throws UsageError, also for a file that cannot be read.
Scene LoadScene(const std::filesystem::path& urdf);

}  // namespace sinew::render
