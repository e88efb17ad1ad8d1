// A picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sinew::render {

inline constexpr std::size_t kBytesOfPixel = 3;

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // sRGB, rows from the top, pixels from the left

  // Both within the picture.
  std::span<const std::uint8_t, kBytesOfPixel> At(int x, int y) const {
    const auto index =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    return std::span<const std::uint8_t, kBytesOfPixel>(&rgb[kBytesOfPixel * index], kBytesOfPixel);
  }
};

}  // namespace sinew::render
