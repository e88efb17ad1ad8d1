#include "components/learn/esn/dataset/file/training_file.h"

#include <optional>

namespace sinew::esn {
using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, Hyperparameters& c) {
  f.Need("neurons", c.neurons, {1, 5000}, "N");
  f("spectral_radius", c.spectral_radius, kPositive, "rho");
  f("input_variance", c.input_variance, kPositive, "alpha, of normalised inputs");
  f("density", c.density, {1e-6, 1.0}, "share of W that is not zero");
  f("shared_rows", c.shared_rows, {1, 4}, "rows of W with the same columns, 4 or 1");
  f("leak", c.leak, {1e-9, 1.0}, "tau");
  f("input_limit", c.input_limit, kPositive, "standard deviations");
  f("seed", c.seed, kNotNegative, "of the random reservoir");
}

static void Describe(config::Fields& f, TrainingConfig& c) {
  Describe(f, c.hyper);
  f("washout_s", c.washout_s, kNotNegative, "the start of every sequence, used for nothing");
  f("ridge_beta", c.ridge_beta, kNotNegative, "left out: the best of the following by GCV");
  f("ridge_beta_lower", c.beta_lower, kPositive, "from here");
  f("ridge_beta_upper", c.beta_upper, kPositive, "to here");
  f("ridge_beta_count", c.beta_count, {2, 1000}, "so many");
}

static void DescribeInputs(config::Fields& f, bool all_joints, DatasetConfig* c) {
  std::vector<std::string> inputs;
  f.Need("inputs", inputs, "signals of docs/formats_esn.md");
  for (const std::string& name : inputs) {
    const std::optional<Signal> signal = SignalFromName(name);
    if (!signal) f.Fail("inputs", "'" + name + "', expected " + std::string(SignalNames()));
    if (all_joints && *signal == Signal::kPlayAngle) {
      f.Fail("inputs", "'" + name + "', expected none of it with 'joints: all'");
    }
    c->inputs.push_back(*signal);
  }
  if (f.reads() && inputs.empty()) {
    f.Fail("inputs", "missing, expected a list of " + std::string(SignalNames()));
  }
}

static void Describe(config::Fields& f, DatasetConfig& c) {
  bool from_data = false;
  f("smoothing_Hz", c.smoothing_Hz, kPositive, "zero-phase filter before differentiation");
  f.Word("derivatives_from", c.derivatives_from_motor, {{"output", false}, {"motor", true}},
         "motor: finer by the gear, right outside the backlash");
  f("play_centre_from_data", from_data, "midway between the extremes that were recorded");
  double centre_rad = 0.0;
  f("play_centre_rad", centre_rad, "of the play; the middle of the contacts");
  c.play_centre_rad = from_data ? std::nullopt : std::optional(centre_rad);
  f("play_margin_rad", c.play_margin_rad, kNotNegative, "nearer to a contact is neither region");
  f("region_guard_s", c.region_guard_s, kNotNegative,
    "samples this near to the other region teach nothing: impacts of the teeth");
  f("blocks", c.blocks, {1, 1000}, "parts of a recording");
  f("train_share", c.train_share, {1e-3, 1.0}, "the first part of a block trains, the rest tests");
}

static void Describe(config::Fields& f, NetworkPlan& plan, double rate_Hz) {
  DatasetConfig& data = plan.dataset;
  f.Need("name", plan.name, "sinew train --network NAME");
  f.NeedWord("target", data.target,
             {{"drive_torque_Nm", Target::kDriveTorque}, {"load_torque_Nm", Target::kLoadTorque}},
             "load torque: load force x link length");
  const auto region = f.NeedWord(
      "region", data.region,
      {{"inside", Region::kInside}, {"outside", Region::kOutside}, {"all", Region::kAll}},
      "of the backlash: samples that teach");
  f.Word("joints", plan.all_joints, {{"one", false}, {"all", true}},
         "all: one network for the whole robot, inputs side by side");
  if (plan.all_joints && data.region != Region::kAll) {
    f.Fail("region", "'" + region.word + "', expected 'all' with 'joints: all'");
  }
  DescribeInputs(f, plan.all_joints, &data);
  Describe(f, data);
  Describe(f, plan.training);
  data.period_s = plan.training.period_s = 1.0 / rate_Hz;
  const int rows = plan.training.hyper.shared_rows;
  f.Require(rows == 1 || rows == 4, "shared_rows", std::to_string(rows) + ", expected 1 or 4");
  f.Require(plan.training.beta_upper > plan.training.beta_lower, "ridge_beta_upper",
            std::to_string(plan.training.beta_upper) + ", expected above ridge_beta_lower");
}

void Describe(config::Fields& f, TrainingPlan& c) {
  f.Need("rate_Hz", c.rate_Hz, kPositive, "of the networks");
  f.NeedList("networks", {1}, "each by its name", [&](config::Fields& network) {
    Describe(network, c.networks.emplace_back(), c.rate_Hz);
  });
}

NetworkPlan LoadNetworkPlan(const std::filesystem::path& path, const std::string& network) {
  const config::Section root = config::Section::Load(path, kTrainSchema);
  const NetworkPlan* chosen = nullptr;
  std::string names;
  const auto plan = config::Read<TrainingPlan>(root);
  for (const NetworkPlan& one : plan.networks) {
    names += (names.empty() ? "" : ", ") + one.name;
    if (one.name != network) continue;
    if (chosen != nullptr) {
      root.Fail("networks", "name '" + network + "' twice, expected each network once");
    }
    chosen = &one;
  }
  if (!chosen) root.Fail("networks", "no network '" + network + "', expected one of " + names);
  return *chosen;
}

}  // namespace sinew::esn
