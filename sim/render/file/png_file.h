// Pictures as PNG files.
#pragma once

#include <filesystem>

#include "sim/render/image.h"

namespace sinew::render {

// As a whole or not at all. Throws UsageError naming the file.
void WritePng(const std::filesystem::path& path, const Image& image);

}  // namespace sinew::render
