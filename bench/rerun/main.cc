// Recordings of the rig run again: identical or not, and how fast.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>

#include "bench/rerun/rig_recording.h"
#include "components/recording/file/file_io.h"
#include "tools/rerun/rerun.h"

namespace {

using namespace sinew;
namespace fs = std::filesystem;

struct BenchOptions {
  int recordings = 20;
  double duration_s = 60.0;
  fs::path folder = fs::temp_directory_path() / "sinew_rerun_bench";
};

// Identical.
bool Again(const fs::path& file, double* wall_s) {
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  node::StopFlag stop;
  const rerun::RerunResult result =
      rerun::Rerun(reader,
                   {.file = file.string(),
                    .session = rerun::SessionsOf(reader, file.string()).at(0),
                    .mode = node::TimeMode::kLockstep,
                    .parts = rerun::PartsOfTheRig(SINEW_SOURCE_DIR "/robots/rig")},
                   stop);
  *wall_s = result.wall_s;
  return result.identical();
}

}  // namespace

int main(int argc, char** argv) {
  BenchOptions options;
  CLI::App app("Rig recordings in lockstep, run again");
  app.add_option("--recordings", options.recordings)->capture_default_str();
  app.add_option("--duration", options.duration_s, "Seconds of each")->capture_default_str();
  app.add_option("--folder", options.folder, "Of the recordings; what is there is replaced");
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::err);
  fs::create_directories(options.folder);
  int identical = 0;
  double wall_s = 0.0;
  for (int seed = 1; seed <= options.recordings; ++seed) {
    const fs::path file = options.folder / "rig.mcap";
    rerun::RecordRig({.rig = SINEW_SOURCE_DIR "/robots/rig",
                      .out = file,
                      .ticks = static_cast<std::uint64_t>(options.duration_s * 240.0),
                      .seed = static_cast<std::uint64_t>(seed)});
    double of_this_s = 0.0;
    const bool same = Again(file, &of_this_s);
    identical += same ? 1 : 0;
    wall_s += of_this_s;
    std::printf("seed %d: %s, %.2f s\n", seed, same ? "identical" : "not identical", of_this_s);
    std::fflush(stdout);
  }
  std::printf("%d of %d identical; %.1f x real time\n", identical, options.recordings,
              options.recordings * options.duration_s / wall_s);
  return identical == options.recordings ? 0 : 1;
}
