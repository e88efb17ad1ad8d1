#include "tools/compose/chain.h"

#include <spdlog/spdlog.h>

#include <array>
#include <functional>
#include <set>

#include "components/learn/esn/participant/component.h"
#include "components/learn/rls/participant/component.h"
#include "components/robot/control/participant/component.h"
#include "components/robot/pneumatics/participant/component.h"
#include "components/robot/reference/participant/component.h"
#include "components/robot/regime/participant/component.h"

namespace sinew::compose {
namespace {

struct ComposedKind {
  const char* program;
  bool before_command;  // the motors wait for it
  std::function<std::unique_ptr<node::Component>(const node::Options&, node::StopFlag&)> make;
};

// In the order in which they answer: each after those whose answers it reads.
const std::array<ComposedKind, 6>& Kinds() {
  static const std::array<ComposedKind, 6> kKinds = {{
      {"sinew-reference", true, reference::MakeReference},
      {"sinew-regime", true, regime::MakeRegime},
      {"sinew-esn", true, [](const auto& o, auto& stop) { return esn::MakeEsn(o, stop); }},
      {"sinew-control", true,
       [](const auto& o, auto& stop) { return control::MakeControl(o, stop); }},
      {"sinew-pneumatics", false, pneumatics::MakePneumatics},
      {"sinew-rls", false, [](const auto& o, auto& stop) { return rls::MakeRls(o, stop); }},
  }};
  return kKinds;
}

std::string ProgramsThatCompose() {
  std::string text;
  for (const ComposedKind& kind : Kinds())
    text += (text.empty() ? "" : ", ") + std::string(kind.program);
  return text;
}

void CheckParts(const std::vector<Part>& parts) {
  std::set<std::string> names;
  for (const Part& part : parts) {
    if (!names.insert(part.name).second) {
      throw UsageError("--component " + part.name + ": given twice, expected a name of its own");
    }
    bool known = false;
    for (const ComposedKind& kind : Kinds()) known = known || part.program == kind.program;
    if (!known) {
      throw UsageError("--component " + part.name + ": '" + part.program +
                       "' cannot be composed, expected one of " + ProgramsThatCompose());
    }
  }
}

}  // namespace

Part ParsePart(const std::string& text) {
  const std::size_t first = text.find('=');
  const std::size_t second = first == std::string::npos ? first : text.find('=', first + 1);
  if (first == 0 || second == std::string::npos || second == first + 1) {
    throw UsageError("--component " + text + ": expected NAME=PROGRAM=CONFIG");
  }
  return {text.substr(0, first), text.substr(first + 1, second - first - 1),
          text.substr(second + 1)};
}

std::vector<std::string> ComposedPrograms() {
  std::vector<std::string> programs;
  for (const ComposedKind& kind : Kinds()) programs.emplace_back(kind.program);
  return programs;
}

std::unique_ptr<node::Component> MakePart(const Part& part, const node::Options& common,
                                          node::StopFlag& stop) {
  CheckParts({part});
  node::Options options = common;
  options.component = part.program.substr(std::string("sinew-").size());
  options.name = part.name;
  options.config_path = part.config;
  for (const ComposedKind& kind : Kinds()) {
    if (part.program == kind.program) return kind.make(options, stop);
  }
  throw std::logic_error("checked above: " + part.program);
}

Chain::Chain(const node::Options& common, node::StopFlag& stop, const std::vector<Part>& parts) {
  CheckParts(parts);
  for (const ComposedKind& kind : Kinds()) {
    for (const Part& part : parts) {
      if (part.program != kind.program) continue;
      node::Options options = common;
      options.composition = &composition_;
      (kind.before_command ? before_command_ : after_command_)
          .push_back(MakePart(part, options, stop));
      spdlog::info("'{}' runs in this thread, {} the command", part.name,
                   kind.before_command ? "before" : "after");
    }
  }
}

void Chain::StepAll(Components* components) {
  for (const auto& component : *components) {
    if (component->Ready()) (void)component->Step();
  }
}

void Chain::Answer() { StepAll(&before_command_); }

void Chain::Finish() {
  StepAll(&after_command_);
  (void)composition_.Flush();
}

}  // namespace sinew::compose
