#include "reproduction/squat_test/photographs.h"

#include <cstdio>

#include "reproduction/squat_test/arms.h"
#include "sim/render/file/film.h"
#include "sim/render/file/recorded_poses.h"
#include "sim/render/file/scene_file.h"

namespace sinew::squat_test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 360, kHeight = 480;  // pixels of one picture
constexpr int kPageWidth = 920;             // of PictureHead
constexpr int kPosesPerSecond = 4;          // the times of the pictures are multiples of 1 / 4 s

fs::path FrameFile(const fs::path& folder, int frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%05d.png", frame);
  return folder / name;
}

// Quotes for gnuplot: in single quotes only the quote itself is doubled.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace

report::Picture PhotographSquat(const fs::path& recording, const fs::path& urdf,
                                const fs::path& folder, render::View view) {
  const render::Scene scene = render::LoadScene(urdf);
  const double spacing_s = kSquat_s / (kPhotographs - 1);
  const render::RecordedPoses recorded = render::ReadPoses(
      recording, scene,
      {.from_s = kStart_s, .to_s = kStart_s + kSquat_s, .frames_per_s = kPosesPerSecond});
  render::FilmOptions options;
  options.frames = folder;
  options.width = kWidth;
  options.height = kHeight;
  options.view = view;
  options.fixed_base = recorded.fixed_base;
  render::Film film(scene, options);
  for (int n = 0; n < kPhotographs; ++n) {
    const auto index = static_cast<std::size_t>(n * spacing_s * kPosesPerSecond);
    if (index >= recorded.poses.size()) break;  // the recording ends before the squat does
    film.Add(recorded.poses[index].time_s, recorded.poses[index].pose);
  }
  film.Finish();

  report::Picture picture;
  const int height = kPageWidth / kPhotographs * kHeight / kWidth;
  picture.script = report::PictureHead(height) +
                   "unset border\nunset tics\nunset grid\nunset key\n"
                   "set margins 0, 0, 0, 0\nset size ratio -1\n"
                   "set multiplot layout 1, " +
                   std::to_string(kPhotographs) + "\n";
  for (int n = 0; n < film.frame_count(); ++n) {
    picture.script += "plot " + Quoted(fs::absolute(FrameFile(folder, n)).string()) +
                      " binary filetype=png with rgbimage\n";
  }
  picture.script += "unset multiplot\n";
  return picture;
}

}  // namespace sinew::squat_test
