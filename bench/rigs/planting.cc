#include "bench/rigs/planting.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "bench/rigs/drawn/random.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using rigs::Rig;

// Noise of its own: that of the plain recordings gave the size.
constexpr std::uint64_t kPlantedNoise = 1;

// Value of the shape parameter whose key begins with `name`.
double ShapeOf(const json& size, const std::string& name) {
  for (const auto& [key, value] : size.at("shape").items()) {
    if (key.rfind(name, 0) == 0) return value;
  }
  throw std::runtime_error(size.at("effect").get<std::string>() + ": no shape '" + name + "'");
}

// Where the current is the largest the model keeps 1 - s I^2 of it, the generator 1 - share.
double SaturationShare(double per_square, double limit) {
  return 1.0 - 1.0 / std::sqrt(1.0 + 2.0 * per_square * limit * limit);
}

double LimitOf(const Rig& rig) {
  return rig.drive == rigs::Drive::kCommand ? 10.0 : rig.current_limit_A;
}

// Size in the generator's unit of what the catalogue states in its own.
struct Conversion {
  const char* effect;
  double (*size)(const Rig& rig, double catalogue);
};
double Same(const Rig&, double x) { return x; }
const Conversion kConversions[] = {
    {"direction_dependent_coulomb", Same},
    {"direction_dependent_viscous", Same},
    {"stribeck", Same},
    {"load_dependent_friction", Same},
    {"drive_efficiency_direction", Same},
    {"transport_delay", Same},
    {"payload_step", Same},
    {"pressure_dependent_friction", Same},
    {"seal_hysteresis", Same},
    {"gear_compliance", Same},
    {"backlash_width", Same},
    // True minus measured there, measured minus true here.
    {"current_offset", Same},
    {"load_cell_gain", [](const Rig&, double gain) { return 1.0 / (1.0 + gain) - 1.0; }},
    {"torque_constant_saturation",
     [](const Rig& rig, double s) { return SaturationShare(s, LimitOf(rig)); }},
    {"flexible_link", [](const Rig& rig, double inertia) { return inertia / rig.link_inertia; }},
    // Force at typical speed: |w|^1.5 (0.15 + |w|)^0.5 of it (bench/rigs/drawn/plant.cc).
    {"quadratic_viscous",
     [](const Rig& rig, double c) { return c * rig.speed() * rig.speed() / std::sqrt(1.15); }},
    {"pressure_lag", Same},
    {"pressure_offset", Same},
};

// Shapes that the generator takes from the report.
void SetShape(const json& size, rigs::Effect* effect) {
  if (effect->name == "stribeck") effect->shape[0] = ShapeOf(size, "stribeck_velocity");
  if (effect->name == "seal_hysteresis") effect->shape[0] = ShapeOf(size, "displacement");
  if (effect->name == "flexible_link") {
    effect->shape[0] = ShapeOf(size, "frequency");
    effect->shape[1] = ShapeOf(size, "damping_ratio");
  }
}

json Read(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  return json::parse(in);
}

rigs::Excitation ExcitationOf(const json& truth) {
  for (const auto e :
       {rigs::Excitation::kDesigned, rigs::Excitation::kTask, rigs::Excitation::kLocked}) {
    if (truth.at("excitation") == rigs::WordOf(e)) return e;
  }
  throw std::runtime_error("excitation " + truth.at("excitation").dump());
}

}  // namespace

std::optional<rigs::Effect> PlantedEffect(const Rig& rig, const json& size) {
  const std::string name = size.at("effect");
  const auto* conversion =
      std::find_if(std::begin(kConversions), std::end(kConversions),
                   [&](const Conversion& entry) { return name == entry.effect; });
  const std::vector<std::string> possible = rigs::EffectsOf(rig, rigs::Kind::kCatalogue);
  if (conversion == std::end(kConversions) ||
      std::find(possible.begin(), possible.end(), name) == possible.end()) {
    return std::nullopt;
  }
  const std::string balance = rigs::FindEffect(name).shows == rigs::Shows::kKinematic ? "K" : "M";
  if (size.at("balance") != balance) return std::nullopt;
  rigs::Effect effect = rigs::DrawEffect(rig, name);
  const double magnitude = conversion->size(rig, size.at("size").get<double>());
  if (!(std::abs(magnitude) <= rigs::LargestSize(rig, name))) return std::nullopt;
  effect.size = std::copysign(magnitude, effect.size);
  SetShape(size, &effect);
  return effect;
}

std::vector<Trial> DrawTrials(const fs::path& cases, const fs::path& reports, int count) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(cases)) {
    if (fs::exists(entry.path() / "truth.json") &&
        fs::exists(reports / entry.path().filename() / "report.json")) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  // Of every effect the trials in the order of the cases.
  std::map<std::string, std::vector<Trial>> of_effect;
  for (const fs::path& folder : folders) {
    const json truth = Read(folder / "truth.json");
    if (truth.at("kind") != "plain" || truth.at("excitation") == "locked") continue;
    const json report = Read(reports / folder.filename() / "report.json");
    if (!report.contains("detectable")) continue;
    const Rig rig = rigs::DrawRig(truth.at("rig"));
    for (const json& size : report.at("detectable").at("sizes")) {
      const std::optional<rigs::Effect> effect = PlantedEffect(rig, size);
      if (!effect) continue;
      std::vector<Trial>& trials = of_effect[effect->name];
      if (trials.empty() || trials.back().plain != folder.filename()) {
        trials.push_back({folder.filename(), *effect});
      }
    }
  }
  std::vector<Trial> out;
  for (std::size_t round = 0; static_cast<int>(out.size()) < count; ++round) {
    const std::size_t before = out.size();
    for (const auto& [name, trials] : of_effect) {
      if (round < trials.size() && static_cast<int>(out.size()) < count) {
        out.push_back(trials[round]);
      }
    }
    if (out.size() == before) break;
  }
  return out;
}

CaseFiles MakePlanted(const Rig& rig, rigs::Excitation excitation, const Trial& trial) {
  const rigs::Sizer sizer(rig, excitation);
  CaseFiles out;
  out.what.kind = rigs::CaseKind::kPlanted;
  out.what.excitation = excitation;
  out.what.effects = {trial.effect.name};
  out.what.name = trial.plain.substr(0, trial.plain.find("plain")) + rigs::WordOf(out.what.kind) +
                  "-" + rigs::WordOf(excitation) + "-" + trial.effect.name;
  const rigs::Run run = rigs::Play(rig, {trial.effect}, excitation);
  Made made;
  made.sized.effect = trial.effect;
  made.sized.measured = sizer.Measure(run, rigs::FindEffect(trial.effect.name).shows);
  made.sized.reached = true;
  made.same_class = sizer.ClassOf(trial.effect);
  out.effects.push_back(std::move(made));
  out.together = out.effects.front().sized.measured;
  out.recordings = ReadRecordings(rig, run, out.what.name);
  return out;
}

int PlantAll(const fs::path& cases, const fs::path& reports, int count, const fs::path& out) {
  int made = 0;
  for (const Trial& trial : DrawTrials(cases, reports, count)) {
    const json truth = Read(cases / trial.plain / "truth.json");
    Rig rig = rigs::DrawRig(truth.at("rig"));
    rig.noise_draw = kPlantedNoise;
    const CaseFiles files = MakePlanted(rig, ExcitationOf(truth), trial);
    const fs::path folder = out / files.what.name;
    if (fs::exists(folder / "truth.json")) continue;
    WriteCase(folder, rig, files);
    ++made;
  }
  return made;
}

}  // namespace sinew::rig_bank
