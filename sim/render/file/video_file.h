// A video file: H.264 (Main profile) in MP4, as every browser and player shows it.
//
// Each frame is encoded with the same quantiser, so that still parts stay still; a frame in each
// kKeyPeriod_s can be shown without those before it. The file is there as a whole after Finish or
// not at all. Thread: one. Throws UsageError (the file cannot be written), std::invalid_argument (a
// frame of another size, odd sizes), std::runtime_error (the encoder refuses).
#pragma once

#include <filesystem>
#include <memory>

#include "sim/render/image.h"

namespace sinew::render {

inline constexpr int kKeyPeriod_s = 2;

class VideoFile {
 public:
  VideoFile(const std::filesystem::path& path, int width, int height, int frames_per_s);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  void Add(const Image& image);
  // Nothing is added afterwards. Throws std::invalid_argument as well: there was no frame.
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::render
