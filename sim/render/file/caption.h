// A line of text in a picture.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "sim/render/image.h"

namespace sinew::render {

// Path at which Debian's fonts-dejavu-core puts its font of even widths.
inline constexpr const char* kCaptionFont = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf";

// Thread: one.
class Caption {
 public:
  // Throws UsageError: no such font, or none that can be scaled.
  Caption(const std::filesystem::path& font, int height_pixels);
  ~Caption();
  Caption(const Caption&) = delete;
  Caption& operator=(const Caption&) = delete;

  // Dark letters; (x, y): the left end of the base line, pixels from the upper left corner. What is
  // outside the picture is cut off. ASCII only: other bytes are left out.
  void Draw(const std::string& text, int x, int y, Image* image) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::render
