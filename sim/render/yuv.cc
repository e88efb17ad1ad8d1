#include "sim/render/yuv.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::render {

namespace {

constexpr double kRedShare = 0.2126, kGreenShare = 0.7152, kBlueShare = 0.0722;
constexpr double kLumaRange = 219.0 / 255.0, kDifferenceRange = 224.0 / 255.0;  // of bytes

double Luma(double red, double green, double blue) {
  return kRedShare * red + kGreenShare * green + kBlueShare * blue;
}

std::uint8_t ToByte(double value) { return static_cast<std::uint8_t>(std::lround(value)); }

}  // namespace

void ToYuv(const Image& image, YuvPicture* out) {
  if (image.width % 2 != 0 || image.height % 2 != 0) {
    throw std::invalid_argument("picture of " + std::to_string(image.width) + " x " +
                                std::to_string(image.height) +
                                " pixels, expected even numbers for a video");
  }
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  out->width = image.width;
  out->height = image.height;
  out->y.resize(width * height);
  out->cb.resize(width * height / 4);
  out->cr.resize(width * height / 4);
  for (std::size_t row = 0; row < height; row += 2) {
    for (std::size_t column = 0; column < width; column += 2) {
      std::array<double, kBytesOfPixel> mean{};
      for (const std::size_t pixel : {row * width + column, row * width + column + 1,
                                      (row + 1) * width + column, (row + 1) * width + column + 1}) {
        const std::uint8_t* rgb = &image.rgb[kBytesOfPixel * pixel];
        out->y[pixel] = ToByte(16.0 + kLumaRange * Luma(rgb[0], rgb[1], rgb[2]));
        for (std::size_t i = 0; i < kBytesOfPixel; ++i) mean[i] += 0.25 * rgb[i];
      }
      const double luma = Luma(mean[0], mean[1], mean[2]);
      const std::size_t quarter = (row / 2) * (width / 2) + column / 2;
      out->cb[quarter] =
          ToByte(128.0 + kDifferenceRange * (mean[2] - luma) / (2.0 * (1.0 - kBlueShare)));
      out->cr[quarter] =
          ToByte(128.0 + kDifferenceRange * (mean[0] - luma) / (2.0 * (1.0 - kRedShare)));
    }
  }
}

}  // namespace sinew::render
