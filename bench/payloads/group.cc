#include "bench/payloads/group.h"

#include "bench/payloads/provider_member.h"
#include "components/learn/esn/participant/component.h"
#include "components/learn/rls/participant/component.h"
#include "components/robot/control/participant/component.h"
#include "components/robot/performance/participant/component.h"
#include "components/robot/pneumatics/participant/component.h"
#include "components/robot/reference/participant/component.h"
#include "components/robot/regime/participant/component.h"
#include "components/robot/residual/participant/component.h"

namespace sinew::payloads {
namespace {

// A maker of two arguments, as the programs have them.
template <class Function>
auto Simple(Function make) {
  return [make](const node::Options& options, Environment& environment) {
    return make(options, environment.stop);
  };
}

MemberSpec Reference(const std::filesystem::path& config) {
  return {"reference", Simple(reference::MakeReference), config, ""};
}
MemberSpec Regime(const std::filesystem::path& config) {
  return {"regime", Simple(regime::MakeRegime), config, ""};
}
MemberSpec Esn(const std::filesystem::path& config) {
  return {"esn", Simple([](const auto& o, auto& stop) { return esn::MakeEsn(o, stop); }), config,
          ""};
}
MemberSpec Control(const std::filesystem::path& config) {
  return {"control",
          Simple([](const auto& o, auto& stop) { return control::MakeControl(o, stop); }), config,
          ""};
}
MemberSpec Pneumatics(const std::filesystem::path& config) {
  return {"pneumatics", Simple(pneumatics::MakePneumatics), config, ""};
}
MemberSpec Rls(const std::filesystem::path& config) {
  return {"rls", Simple([](const auto& o, auto& stop) { return rls::MakeRls(o, stop); }), config,
          ""};
}
MemberSpec Residual(const std::filesystem::path& config) {
  return {"residual",
          Simple([](const auto& o, auto& stop) { return residual::MakeResidual(o, stop); }), config,
          ""};
}

MemberSpec Performance(const std::filesystem::path& config) {
  return {"performance", Simple(performance::MakePerformance), config, ""};
}

}  // namespace

std::vector<Group> AllGroups(const std::filesystem::path& folder,
                             const std::filesystem::path& rig) {
  return {
      {"networks",
       {Reference(rig / "reference_watch.yaml"),
        Regime(rig / "regime_active.yaml"),
        Esn(rig / "esn_adaptive.yaml"),
        Control(folder / "control_networks.yaml"),
        Pneumatics(folder / "pneumatics.yaml"),
        Rls(rig / "rls.yaml"),
        Residual(folder / "residual.yaml"),
        Performance(rig / "performance.yaml"),
        {"provider", MakeProvider, rig / "surrogate.yaml", "surrogate"}}},
      {"models",
       {Reference(rig / "reference_benchmark.yaml"),
        Regime(rig / "regime.yaml"),
        Esn(rig / "esn_model.yaml"),
        Control(folder / "control_model.yaml"),
        Pneumatics(rig / "pneumatics.yaml"),
        Residual(folder / "residual.yaml"),
        {"provider", MakeProvider, rig / "surrogate.yaml", "surrogate"}}},
      {"recording",
       {Control(rig / "control_position.yaml"),
        Reference(rig / "reference_watch.yaml"),
        {"logger", MakeLogger, "", ""}}},
  };
}

std::unique_ptr<node::Component> Make(const MemberSpec& spec, Environment& environment) {
  node::Options options;
  options.component = spec.kind.empty() ? spec.name : spec.kind;
  options.name = spec.name;
  options.config_path = spec.config;
  options.composition = &environment.composition;
  return spec.make(options, environment);
}

}  // namespace sinew::payloads
