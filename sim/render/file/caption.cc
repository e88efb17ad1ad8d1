#include "sim/render/file/caption.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include "components/base/config/config.h"

namespace sinew::render {

namespace {

constexpr int kInk = 40;  // of red, green and blue

// One letter's pixels; coverage 255: all ink.
void Blend(const FT_Bitmap& letter, int left, int top, Image* image) {
  for (int row = 0; row < static_cast<int>(letter.rows); ++row) {
    for (int column = 0; column < static_cast<int>(letter.width); ++column) {
      const int x = left + column, y = top + row;
      if (x < 0 || y < 0 || x >= image->width || y >= image->height) continue;
      const int coverage = letter.buffer[row * letter.pitch + column];
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image->width) +
                         static_cast<std::size_t>(x);
      for (std::size_t i = 0; i < kBytesOfPixel; ++i) {
        std::uint8_t& value = image->rgb[kBytesOfPixel * pixel + i];
        value = static_cast<std::uint8_t>((value * (255 - coverage) + kInk * coverage + 127) / 255);
      }
    }
  }
}

}  // namespace

struct Caption::Impl {
  Impl(const std::filesystem::path& font, int height_pixels) {
    if (FT_Init_FreeType(&library) != 0) throw UsageError("captions: FreeType does not start");
    if (FT_New_Face(library, font.c_str(), 0, &face) != 0) {
      FT_Done_FreeType(library);
      throw UsageError(font.string() + ": no font, expected that of fonts-dejavu-core");
    }
    if (FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(height_pixels)) != 0) {
      FT_Done_FreeType(library);  // its faces with it
      throw UsageError(font.string() + ": has no letters of " + std::to_string(height_pixels) +
                       " pixels");
    }
  }
  ~Impl() { FT_Done_FreeType(library); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  FT_Library library = nullptr;
  FT_Face face = nullptr;
};

Caption::Caption(const std::filesystem::path& font, int height_pixels)
    : impl_(std::make_unique<Impl>(font, height_pixels)) {}

Caption::~Caption() = default;

void Caption::Draw(const std::string& text, int x, int y, Image* image) const {
  const FT_Face face = impl_->face;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code >= 0x80 || FT_Load_Char(face, code, FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = face->glyph;
    Blend(glyph->bitmap, x + glyph->bitmap_left, y - glyph->bitmap_top, image);
    x += static_cast<int>(glyph->advance.x >> 6);  // of 1/64 pixel
  }
}

}  // namespace sinew::render
