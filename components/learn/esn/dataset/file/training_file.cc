#include "components/learn/esn/dataset/file/training_file.h"

#include <optional>
#include <stdexcept>

#include "components/base/config/config.h"

namespace sinew::esn {
namespace {

constexpr std::string_view kSchema = "sinew-esn-train/1";

NetworkPlan ReadNetwork(const config::Section& s, double rate_Hz) {
  NetworkPlan plan;
  plan.name = s.Text("name");
  DatasetConfig& data = plan.dataset;
  TrainingConfig& training = plan.training;

  const std::vector<std::string> targets = {"drive_torque_Nm", "load_torque_Nm"};
  data.target =
      s.Choice("target", targets) == targets[0] ? Target::kDriveTorque : Target::kLoadTorque;
  const std::string region = s.Choice("region", {"inside", "outside", "all"});
  data.region = region == "inside"    ? Region::kInside
                : region == "outside" ? Region::kOutside
                                      : Region::kAll;
  plan.all_joints = s.ChoiceOr("joints", "one", {"one", "all"}) == "all";
  if (plan.all_joints && data.region != Region::kAll) {
    s.Fail("region", "'" + region + "', expected 'all' with 'joints: all'");
  }
  for (const std::string& name : s.TextsOr("inputs", {})) {
    const std::optional<Signal> signal = SignalFromName(name);
    if (!signal) s.Fail("inputs", "'" + name + "', expected " + std::string(SignalNames()));
    if (plan.all_joints && *signal == Signal::kPlayAngle) {
      s.Fail("inputs", "'" + name + "', expected none of it with 'joints: all'");
    }
    data.inputs.push_back(*signal);
  }
  if (data.inputs.empty())
    s.Fail("inputs", "missing, expected a list of " + std::string(SignalNames()));
  data.period_s = 1.0 / rate_Hz;
  data.smoothing_Hz = s.NumberOr("smoothing_Hz", data.smoothing_Hz, config::kPositive);
  data.derivatives_from_motor =
      s.ChoiceOr("derivatives_from", "output", {"output", "motor"}) == "motor";
  if (s.BoolOr("play_centre_from_data", false)) {
    data.play_centre_rad.reset();
  } else {
    data.play_centre_rad = s.NumberOr("play_centre_rad", 0.0);
  }
  data.play_margin_rad = s.NumberOr("play_margin_rad", data.play_margin_rad, config::kNotNegative);
  data.region_guard_s = s.NumberOr("region_guard_s", data.region_guard_s, config::kNotNegative);
  data.blocks = static_cast<int>(s.IntegerOr("blocks", data.blocks, {1, 1000}));
  data.train_share = s.NumberOr("train_share", data.train_share, {1e-3, 1.0});

  Hyperparameters& hyper = training.hyper;
  hyper.neurons = static_cast<int>(s.Integer("neurons", {1, 5000}));
  hyper.spectral_radius = s.NumberOr("spectral_radius", hyper.spectral_radius, config::kPositive);
  hyper.input_variance = s.NumberOr("input_variance", hyper.input_variance, config::kPositive);
  hyper.density = s.NumberOr("density", hyper.density, {1e-6, 1.0});
  hyper.shared_rows = static_cast<int>(s.IntegerOr("shared_rows", hyper.shared_rows, {1, 4}));
  if (hyper.shared_rows != 1 && hyper.shared_rows != 4) {
    s.Fail("shared_rows", std::to_string(hyper.shared_rows) + ", expected 1 or 4");
  }
  hyper.leak = s.NumberOr("leak", hyper.leak, {1e-9, 1.0});
  hyper.input_limit = s.NumberOr("input_limit", hyper.input_limit, config::kPositive);
  hyper.seed = static_cast<std::uint64_t>(s.IntegerOr("seed", 1, config::kNotNegative));
  training.period_s = data.period_s;
  training.washout_s = s.NumberOr("washout_s", training.washout_s, config::kNotNegative);
  if (s.Has("ridge_beta")) training.ridge_beta = s.Number("ridge_beta", config::kNotNegative);
  training.beta_lower = s.NumberOr("ridge_beta_lower", training.beta_lower, config::kPositive);
  training.beta_upper = s.NumberOr("ridge_beta_upper", training.beta_upper, config::kPositive);
  if (!(training.beta_upper > training.beta_lower)) {
    s.Fail("ridge_beta_upper",
           std::to_string(training.beta_upper) + ", expected above ridge_beta_lower");
  }
  training.beta_count =
      static_cast<int>(s.IntegerOr("ridge_beta_count", training.beta_count, {2, 1000}));
  s.RejectUnknownKeys();
  return plan;
}

NetworkPlan Read(const config::Section& root, const std::string& network) {
  const double rate_Hz = root.Number("rate_Hz", config::kPositive);
  std::optional<NetworkPlan> chosen;
  std::string names;
  for (const config::Section& section : root.List("networks")) {
    NetworkPlan plan = ReadNetwork(section, rate_Hz);
    names += (names.empty() ? "" : ", ") + plan.name;
    if (plan.name != network) continue;
    if (chosen) section.Fail("name", "'" + network + "' twice, expected each network once");
    chosen = std::move(plan);
  }
  root.RejectUnknownKeys();
  if (!chosen) root.Fail("networks", "no network '" + network + "', expected one of " + names);
  return *chosen;
}

}  // namespace

NetworkPlan LoadNetworkPlan(const std::filesystem::path& path, const std::string& network) {
  return Read(config::Section::Load(path, kSchema), network);
}

NetworkPlan ParseNetworkPlan(const std::string& text, const std::string& name,
                             const std::string& network) {
  return Read(config::Section::Parse(text, name, kSchema), network);
}

}  // namespace sinew::esn
