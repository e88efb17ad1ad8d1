// sinew-world: the simulated robot as a state provider.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/robot/provider/participant/run_provider.h"
#include "sim/render/participant/plant_film.h"
#include "sim/world/file/world_file.h"

int main(int argc, char** argv) {
  using namespace sinew;
  provider::ProviderOptions provider_options;
  std::filesystem::path model_path, urdf_path, video;
  const auto body = [&](const node::Options& options, node::StopFlag& stop) {
    if (options.config_path.empty()) throw UsageError("--config is missing, expected a world file");
    world::WorldFile file = world::LoadWorldFile(options.config_path, model_path, urdf_path);
    file.seed = options.seed;
    const provider::GuardConfig guard = provider::LoadGuardConfig(file.guard);
    file.guard.RejectUnknownKeys();
    const auto plant = world::MakeWorld(file, options.config_path);
    std::optional<render::PlantFilm> film;
    if (!video.empty()) {
      std::vector<std::string> names;
      for (const auto& joint : file.config.model.joints) names.push_back(joint.name);
      film.emplace(*plant, names, file.urdf, video, options.mode == node::TimeMode::kLockstep);
      provider_options.stepped = film->Observer();
    }
    provider::RunProvider(options, stop, provider_options, guard, *plant);
    if (film) film->Finish();
  };
  return node::RunParticipant(
      argc, argv, "world",
      "The robot simulated: rigid bodies from a URDF, "
      "actuators from a model file",
      body, [&](CLI::App& app) {
        provider::AddProviderOptions(app, &provider_options);
        node::AddOption(app, "--model", &model_path,
                        "Model file instead of the one in the configuration");
        node::AddOption(app, "--urdf", &urdf_path, "URDF instead of the one in the configuration");
        node::AddOption(app, "--view", &video, "Video of the simulation, FILE.mp4");
      });
}
