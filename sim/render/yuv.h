// A picture as video encoders take it: luma and two colour differences, each colour difference
// once for a square of 2 x 2 pixels.
//
// ITU-R BT.709-6, 3.2 to 3.4, in the narrow range of 8 bits (R', G', B' from 0 to 1):
//
//     E = 0.2126 R' + 0.7152 G' + 0.0722 B'
//     Y = 16 + 219 E,  Cb = 128 + 224 (B' - E) / 1.8556,  Cr = 128 + 224 (R' - E) / 1.5748
//
// A colour difference is that of the mean of its four pixels. Thread: free function.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/render/image.h"

namespace sinew::render {

struct YuvPicture {
  int width = 0;  // of the luma; the others have half of it each way
  int height = 0;
  std::vector<std::uint8_t> y, cb, cr;  // rows from the top
};

// Throws std::invalid_argument: width or height is odd. Allocates where `out` has another size.
void ToYuv(const Image& image, YuvPicture* out);

}  // namespace sinew::render
