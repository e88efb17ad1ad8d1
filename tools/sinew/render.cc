#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "components/topics/node/time_option.h"
#include "sim/render/file/film.h"
#include "sim/render/file/recorded_poses.h"
#include "sim/render/file/scene_file.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {

namespace {

struct RenderOptions {
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path urdf;
  std::string seen_from = "three-quarter";
  render::FilmOptions film;
  render::RecordedPosesOptions poses;
};

void Render(RenderOptions options) {
  if (options.seen_from == "side") options.film.view = render::View::kSide;
  options.poses.frames_per_s = options.film.frames_per_s;
  const render::Scene scene = render::LoadScene(options.urdf);
  if (scene.mesh_count > 0) {
    std::cerr << "sinew render: " << scene.mesh_count << " meshes of " << options.urdf.string()
              << " are not drawn\n";
  }
  const render::RecordedPoses recorded =
      render::ReadPoses(OnlyOne(options.recordings), scene, options.poses);
  options.film.fixed_base = recorded.fixed_base;
  render::Film film(scene, options.film);
  for (const render::TimedPose& one : recorded.poses) film.Add(one.time_s, one.pose);
  film.Finish();
  std::cout << film.frame_count() << " frames from " << recorded.poses.front().time_s << " s to "
            << recorded.poses.back().time_s << " s\n";
}

}  // namespace

void AddRenderCommand(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = app.add_subcommand("render", "Draw a recording: a video, PNG files or both");
  AddRecordings(*command, "--recording", &options->recordings, "MCAP with joint_state")->required();
  command->add_option("--urdf", options->urdf, "URDF of the robot, with visual elements")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--out", options->film.video, "Video, e.g. squat.mp4")->type_name("FILE.mp4");
  command->add_option("--frames", options->film.frames, "Folder for a PNG file of each frame")
      ->type_name("DIR");
  command->add_option("--from", options->poses.from_s, "Start, s since the first state")
      ->check(node::IsTime(node::Zero::kAllowed))
      ->capture_default_str();
  command->add_option("--to", options->poses.to_s, "End, s since the first state; default: the end")
      ->check(node::IsTime(node::Zero::kAllowed));
  command->add_option("--rate", options->film.frames_per_s, "Frames in a second of recorded time")
      ->check(CLI::Range(1, 120))
      ->capture_default_str();
  command->add_option("--width", options->film.width, "Pixels, even")->capture_default_str();
  command->add_option("--height", options->film.height, "Pixels, even")->capture_default_str();
  command->add_option("--view", options->seen_from, "From where the robot is seen")
      ->check(CLI::IsMember({"three-quarter", "side"}))
      ->capture_default_str();
  command->footer(
      "The base is that of sim_body_truth; without it, of a biped, its lower sole is flat on the "
      "ground.\n\n"
      "Examples:\n"
      "  sinew render squat.mcap --urdf robots/biped/biped.urdf --out squat.mp4\n"
      "  sinew render squat.mcap --urdf robots/biped/biped.urdf --frames pictures \\\n"
      "    --from 2 --to 4 --view side");
  command->callback([options] { Render(*options); });
}

}  // namespace sinew::tools
