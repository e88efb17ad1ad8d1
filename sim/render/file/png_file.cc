#include "sim/render/file/png_file.h"

#include <png.h>

#include <string>

#include "components/base/config/config.h"

namespace sinew::render {

void WritePng(const std::filesystem::path& path, const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string content(size, '\0');
  if (png_image_write_to_memory(&png, content.data(), &size, 0, image.rgb.data(), 0, nullptr) ==
      0) {
    throw UsageError(path.string() + ": no PNG file: " + png.message);
  }
  content.resize(size);
  config::WriteFileAtomically(path, content);
}

}  // namespace sinew::render
