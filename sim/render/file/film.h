// Pictures of a robot at a constant rate: a video, PNG files, or both.
//
// Thread: one at a time. Throws UsageError for what the user can change, std::runtime_error for
// what renderer or encoder refuse.
#pragma once

#include <filesystem>
#include <optional>

#include "sim/render/camera.h"
#include "sim/render/file/caption.h"
#include "sim/render/file/video_file.h"
#include "sim/render/renderer.h"
#include "sim/render/scene.h"

namespace sinew::render {

struct FilmOptions {
  std::filesystem::path video;   // FILE.mp4; empty: none
  std::filesystem::path frames;  // folder of frame_00000.png and so on; empty: none
  int width = 960;               // pixels, even
  int height = 720;
  int frames_per_s = 25;  // of the time that is given with the poses
  View view = View::kThreeQuarter;
  bool fixed_base = false;  // for the camera, see CameraOf
};

class Film {
 public:
  // Makes the folder of the frames. Throws UsageError: neither video nor frames, a video that is
  // not called .mp4, impossible numbers.
  Film(const Scene& scene, const FilmOptions& options);

  // The next frame, with time_s as its caption.
  void Add(double time_s, const RobotPose& pose);
  int frame_count() const { return frame_count_; }
  // Writes the end of the video, which is not there otherwise. Nothing is added afterwards.
  void Finish();

 private:
  const FilmOptions options_;
  const Camera camera_;
  const Renderer renderer_;
  const Caption caption_;
  std::optional<VideoFile> video_;
  int frame_count_ = 0;
};

}  // namespace sinew::render
