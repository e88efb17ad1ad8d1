#include <CLI/CLI.hpp>
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/model/effects/effect.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

using effects::EffectInfo;
using effects::ParameterInfo;
using types::JointKind;

struct EffectsOptions {
  std::string name;
  std::string kind = "rotary";
  bool json = false;
};

std::string_view RoleName(effects::Role role) {
  switch (role) {
    case effects::Role::kDrive:
      return "drive";
    case effects::Role::kInertia:
      return "inertia";
    case effects::Role::kPassive:
      return "passive";
  }
  return "";
}

// As in a model file: name and unit.
nlohmann::ordered_json ToJson(const std::vector<ParameterInfo>& parameters, JointKind kind) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ParameterInfo& parameter : parameters) {
    list.push_back({{"key", effects::ParameterKey(parameter, kind)},
                    {"meaning", parameter.meaning},
                    {"lower", parameter.lower},
                    {"upper", parameter.upper},
                    {"default", parameter.default_value}});
  }
  return list;
}

nlohmann::ordered_json ToJson(const EffectInfo& info, JointKind kind) {
  return {{"name", info.name},
          {"title", info.title},
          {"formula", info.formula},
          {"source", info.source},
          {"role", RoleName(info.role)},
          {"balance", BalanceName(info.balance)},
          {"linear", ToJson(info.linear, kind)},
          {"nonlinear", ToJson(info.nonlinear, kind)},
          {"signature", info.signature},
          {"variable", info.variable},
          {"confounders", info.confounders},
          {"separating_excitation", info.separating_excitation},
          {"needs", info.needs}};
}

void PrintParameters(const char* title, const std::vector<ParameterInfo>& parameters,
                     JointKind kind) {
  if (parameters.empty()) return;
  std::cout << title << ":\n";
  for (const ParameterInfo& parameter : parameters) {
    std::cout << "  " << effects::ParameterKey(parameter, kind) << "  " << parameter.lower << " to "
              << parameter.upper << ", default " << parameter.default_value << "  "
              << parameter.meaning << '\n';
  }
}

void PrintOne(const EffectInfo& info, JointKind kind) {
  std::cout << info.name << ": " << info.title << "\n  " << info.formula
            << "\nsource: " << info.source << "\nbalance: " << BalanceName(info.balance)
            << ", role: " << RoleName(info.role) << '\n';
  PrintParameters("linear parameters", info.linear, kind);
  PrintParameters("nonlinear parameters", info.nonlinear, kind);
  std::cout << "signature: " << info.signature << "\nresidual follows: " << info.variable
            << "\nlooks like: " << types::Joined(info.confounders)
            << "\ntold apart by: " << info.separating_excitation
            << "\nneeds: " << types::Joined(info.needs) << '\n';
}

void RunEffects(const EffectsOptions& options) {
  const std::vector<std::string> names = effects::EffectNames();
  if (!options.name.empty() && std::find(names.begin(), names.end(), options.name) == names.end()) {
    throw UsageError("effect '" + options.name + "': unknown, expected one of " +
                     types::Joined(names));
  }
  const JointKind kind = options.kind == "linear" ? JointKind::kPrismatic : JointKind::kRevolute;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (!options.name.empty() && name != options.name) continue;
    const auto effect = effects::MakeEffect(name, {}, balance);
    if (options.json) {
      list.push_back(ToJson(effect->info(), kind));
    } else if (!options.name.empty()) {
      PrintOne(effect->info(), kind);
    } else {
      std::cout << std::left << std::setw(static_cast<int>(width) + 2) << name
                << effect->info().title
                << (balance == effects::Balance::kMotion
                        ? std::string()
                        : " (" + std::string(BalanceName(balance)) + " balance)")
                << '\n';
    }
  }
  if (options.json) std::cout << types::JsonText(list, 2) << '\n';
}

}  // namespace

void AddEffectsCommand(CLI::App& app) {
  auto options = std::make_shared<EffectsOptions>();
  CLI::App* command = app.add_subcommand("effects", "List the catalogue of physical effects");
  command->add_option("name", options->name, "Show one effect in full")->type_name("EFFECT");
  command->add_option("--kind", options->kind, "Units of a rotary or a linear joint")
      ->check(CLI::IsMember({"rotary", "linear"}));
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Examples:\n"
      "  sinew effects\n"
      "  sinew effects stribeck\n"
      "  sinew effects --json | python3 -m json.tool");
  command->callback([options] { RunEffects(*options); });
}

}  // namespace sinew::tools
