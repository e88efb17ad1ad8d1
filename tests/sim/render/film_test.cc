// A film of the squat: a video, PNG files and their captions.
#include "sim/render/file/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cstdlib>

#include "components/base/config/config.h"
#include "sim/render/camera.h"
#include "sim/render/file/caption.h"
#include "sim/render/file/png_file.h"
#include "sim/render/renderer.h"
#include "tests/sim/render/biped_squat.h"
#include "tests/support/temporary_folder.h"

namespace sinew::render {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kFilmWidth = 320, kFilmHeight = 240;

Image ReadPng(const fs::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&png, path.c_str()), 0) << path;
  png.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  EXPECT_NE(png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr), 0) << path;
  return image;
}

FilmOptions SmallFilm() {
  FilmOptions options;
  options.width = kFilmWidth;
  options.height = kFilmHeight;
  return options;
}

TEST(Film, WritesAVideoAndItsFrames) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  FilmOptions options = SmallFilm();
  options.video = folder.path() / "squat.mp4";
  options.frames = folder.path() / "frames" / "squat";
  Film film(squat.scene(), options);
  for (int i = 0; i < 5; ++i) film.Add(0.04 * i, squat.At(0.04 * i));
  EXPECT_FALSE(fs::exists(options.video));
  film.Finish();
  EXPECT_EQ(film.frame_count(), 5);
  EXPECT_GT(fs::file_size(options.video), 1000u);
  EXPECT_EQ(std::distance(fs::directory_iterator(options.frames), {}), 5);
  EXPECT_TRUE(fs::exists(options.frames / "frame_00004.png"));
}

// The picture is the renderer's, but for the caption in its lower left corner.
TEST(Film, AFrameIsThePictureWithItsTime) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  FilmOptions options = SmallFilm();
  options.frames = folder.path();
  Film film(squat.scene(), options);
  film.Add(1.28, squat.At(1.28));
  const Image frame = ReadPng(folder.path() / "frame_00000.png");
  const Image bare = Renderer(squat.scene(), kFilmWidth, kFilmHeight)
                         .Render(squat.At(1.28), CameraOf(squat.scene(), View::kThreeQuarter));
  int changed = 0;
  for (int y = 0; y < kFilmHeight; ++y) {
    for (int x = 0; x < kFilmWidth; ++x) {
      if (std::ranges::equal(frame.At(x, y), bare.At(x, y))) continue;
      ++changed;
      EXPECT_LT(x, kFilmWidth / 3);
      EXPECT_GT(y, kFilmHeight * 9 / 10);
    }
  }
  EXPECT_GT(changed, 50);
}

TEST(Film, RefusesWhatItCannotWrite) {
  const BipedSquat squat;
  const auto error_of = [&](const FilmOptions& options) -> std::string {
    try {
      const Film film(squat.scene(), options);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  };
  FilmOptions options = SmallFilm();
  EXPECT_THAT(error_of(options), HasSubstr("nothing to write"));
  options.video = "squat.avi";
  EXPECT_THAT(error_of(options), HasSubstr("squat.avi: expected a name that ends in .mp4"));
  options.video = "/no/such/folder/squat.mp4";
  EXPECT_THAT(error_of(options), HasSubstr("/no/such/folder/squat.mp4"));
  options.width = 321;
  EXPECT_THAT(error_of(options), HasSubstr("321 x 240"));
  options.width = kFilmWidth;
  options.frames_per_s = 0;
  EXPECT_THAT(error_of(options), HasSubstr("frames in a second: 0"));
}

TEST(Caption, IsDarkAndCutAtTheEdges) {
  const Image blank{64, 32, std::vector<std::uint8_t>(kBytesOfPixel * 64 * 32, 255)};
  const Caption caption(kCaptionFont, 20);
  Image image = blank;
  caption.Draw("8", 20, 24, &image);
  int ink = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (image.At(x, y)[0] > 100) continue;
      ++ink;
      EXPECT_GE(x, 20);
      EXPECT_LE(y, 24);
    }
  }
  EXPECT_GT(ink, 20);
  caption.Draw("8888888888", -5, 3, &image);  // beyond three edges
  image = blank;
  caption.Draw("\xc3\xa9\xff", 20, 24, &image);
  EXPECT_EQ(image.rgb, blank.rgb);
  EXPECT_THROW(Caption("/no/such/font.ttf", 20), UsageError);
}

TEST(PngFile, GivesThePixelsBack) {
  const testing::TemporaryFolder folder;
  Image image{5, 3, {}};
  for (int i = 0; i < 45; ++i) image.rgb.push_back(static_cast<std::uint8_t>(5 * i));
  WritePng(folder.path() / "a.png", image);
  EXPECT_EQ(ReadPng(folder.path() / "a.png").rgb, image.rgb);
  EXPECT_THROW(WritePng("/no/such/folder/a.png", image), UsageError);
}

}  // namespace
}  // namespace sinew::render
