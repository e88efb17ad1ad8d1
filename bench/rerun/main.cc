// Recordings of the rig run again: identical or not, and how fast.
#include <sinew_idl/snapshot.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "bench/rerun/rig_recording.h"
#include "components/record/recording/file/file_io.h"
#include "tools/rerun/rerun.h"

namespace {

using namespace sinew;
namespace fs = std::filesystem;

constexpr double kRate_Hz = 240.0;  // of rig_recording.h

struct BenchOptions {
  int recordings = 20;
  double duration_s = 60.0;
  fs::path folder = fs::temp_directory_path() / "sinew_rerun_bench";
};

// All components ask for their state a little before half of the recording is over.
void AskForSnapshots(node::Node& operators, std::uint64_t session_id, std::uint64_t after_tick) {
  auto writer = operators.MakeWriter(node::kSnapshotRequest);
  msg::SnapshotRequest request;
  request.header.session_id = session_id;
  request.after_tick = after_tick;
  if (writer.Write(request) != node::WriteStatus::kOk) std::fputs("request not sent\n", stderr);
}

// Identical. from_s: from the last snapshot up to there.
bool Again(const fs::path& file, std::optional<double> from_s, double* wall_s) {
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  node::StopFlag stop;
  const rerun::RerunResult result =
      rerun::Rerun(reader,
                   {.file = file.string(),
                    .session = rerun::SessionsOf(reader, file.string()).at(0),
                    .mode = node::TimeMode::kLockstep,
                    .parts = rerun::PartsOfTheRig(SINEW_SOURCE_DIR "/robots/rig"),
                    .from_s = from_s},
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
  const auto ticks = static_cast<std::uint64_t>(options.duration_s * kRate_Hz);
  const std::uint64_t half = ticks / 2;
  int identical = 0, from_half = 0;
  double wall_s = 0.0;
  for (int seed = 1; seed <= options.recordings; ++seed) {
    const fs::path file = options.folder / "rig.mcap";
    rerun::RecordRig(
        {.rig = SINEW_SOURCE_DIR "/robots/rig",
         .out = file,
         .ticks = ticks,
         .seed = static_cast<std::uint64_t>(seed),
         .before = [half](node::Node& operators, std::uint64_t session_id, std::uint64_t tick) {
           if (tick == 0) AskForSnapshots(operators, session_id, half);
         }});
    double of_this_s = 0.0, of_half_s = 0.0;
    const bool same = Again(file, std::nullopt, &of_this_s);
    // A tick later, so that no rounding leaves the snapshot out.
    const bool same_half = Again(file, static_cast<double>(half + 1) / kRate_Hz, &of_half_s);
    identical += same ? 1 : 0;
    from_half += same_half ? 1 : 0;
    wall_s += of_this_s;
    std::printf("seed %d: %s, %.2f s; from the snapshot of tick %llu: %s, %.2f s\n", seed,
                same ? "identical" : "not identical", of_this_s,
                static_cast<unsigned long long>(half), same_half ? "identical" : "not identical",
                of_half_s);
    std::fflush(stdout);
  }
  std::printf("%d of %d identical, %d from the snapshot; %.1f x real time\n", identical,
              options.recordings, from_half, options.recordings * options.duration_s / wall_s);
  return identical == options.recordings && from_half == options.recordings ? 0 : 1;
}
