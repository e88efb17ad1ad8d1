#include "sim/render/file/film.h"

#include <optional>
#include <string>

#include "components/base/config/config.h"
#include "components/base/types/text.h"
#include "sim/render/file/caption.h"
#include "sim/render/file/png_file.h"
#include "sim/render/file/video_file.h"
#include "sim/render/renderer.h"

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

struct Film::Impl {
  Impl(const Scene& scene, const FilmOptions& film_options)
      : options(Checked(film_options)),
        camera(CameraOf(scene, options.view, options.fixed_base)),
        renderer(scene, options.width, options.height),
        caption(kCaptionFont, static_cast<int>(kLetterHeight * options.height)) {
    if (!options.video.empty()) {
      video.emplace(options.video, options.width, options.height, options.frames_per_s);
    }
    if (options.frames.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(options.frames, error);
    if (error) throw UsageError(options.frames.string() + ": " + error.message());
  }

  FilmOptions options;
  Camera camera;
  Renderer renderer;
  Caption caption;
  std::optional<VideoFile> video;
  int frame_count = 0;
};

Film::Film(const Scene& scene, const FilmOptions& options)
    : impl_(std::make_unique<Impl>(scene, options)) {}

Film::~Film() = default;

void Film::Add(double time_s, const RobotPose& pose) {
  Image image = impl_->renderer.Render(pose, Follow(impl_->camera, pose));
  const int margin = static_cast<int>(kLetterMargin * impl_->options.height);
  impl_->caption.Draw(types::Text("t = %.2f s", time_s), margin, impl_->options.height - margin,
                      &image);
  if (impl_->video) impl_->video->Add(image);
  if (!impl_->options.frames.empty()) {
    WritePng(impl_->options.frames / types::Text("frame_%05d.png", impl_->frame_count), image);
  }
  ++impl_->frame_count;
}

int Film::frame_count() const { return impl_->frame_count; }

void Film::Finish() {
  if (impl_->video) impl_->video->Finish();
}

}  // namespace sinew::render
