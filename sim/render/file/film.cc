#include "sim/render/file/film.h"

#include <string>

#include "components/base/config/config.h"
#include "components/base/types/text.h"
#include "sim/render/file/png_file.h"

namespace sinew::render {

namespace {

// Shares of the picture's height.
constexpr double kLetterHeight = 0.033, kLetterMargin = 0.035;

FilmOptions Checked(const FilmOptions& options) {
  if (options.video.empty() && options.frames.empty()) {
    throw UsageError("nothing to write: expected a video or a folder for its frames");
  }
  if (!options.video.empty() && options.video.extension() != ".mp4") {
    throw UsageError(options.video.string() + ": expected a name that ends in .mp4");
  }
  if (options.frames_per_s < 1 || options.frames_per_s > 120) {
    throw UsageError("frames in a second: " + std::to_string(options.frames_per_s) +
                     ", expected 1 to 120");
  }
  for (const int pixels : {options.width, options.height}) {
    if (pixels < 64 || pixels > kLargestPicture || pixels % 2 != 0) {
      throw UsageError(
          "picture of " + std::to_string(options.width) + " x " + std::to_string(options.height) +
          " pixels, expected even numbers from 64 to " + std::to_string(kLargestPicture));
    }
  }
  return options;
}

}  // namespace

Film::Film(const Scene& scene, const FilmOptions& options)
    : options_(Checked(options)),
      camera_(CameraOf(scene, options.view, options.fixed_base)),
      renderer_(scene, options.width, options.height),
      caption_(kCaptionFont, static_cast<int>(kLetterHeight * options.height)) {
  if (!options.video.empty()) {
    video_.emplace(options.video, options.width, options.height, options.frames_per_s);
  }
  if (options.frames.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(options.frames, error);
  if (error) throw UsageError(options.frames.string() + ": " + error.message());
}

void Film::Add(double time_s, const RobotPose& pose) {
  Image image = renderer_.Render(pose, Follow(camera_, pose));
  const int margin = static_cast<int>(kLetterMargin * options_.height);
  caption_.Draw(types::Text("t = %.2f s", time_s), margin, options_.height - margin, &image);
  if (video_) video_->Add(image);
  if (!options_.frames.empty()) {
    WritePng(options_.frames / types::Text("frame_%05d.png", frame_count_), image);
  }
  ++frame_count_;
}

void Film::Finish() {
  if (video_) video_->Finish();
}

}  // namespace sinew::render
