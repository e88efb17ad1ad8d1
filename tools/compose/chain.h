// The participants of a composition in the order in which they answer a tick.
//
// Those whose answer the motors wait for run between the provider's state and its command, in the
// order of the table in chain.cc; the others, and DDS, follow when the plant has its command. What
// throws ends the provider, which switches the motors off. Thread: the provider's.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "components/robot/provider/participant/provider_options.h"
#include "components/topics/node/component.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/options.h"

namespace sinew::compose {

struct Part {
  std::string name;
  std::string program;           // e.g. sinew-control
  std::filesystem::path config;  // may be empty
};

// NAME=PROGRAM=CONFIG. Throws UsageError.
Part ParsePart(const std::string& text);

// Programs that can be composed, in the order in which they answer a tick.
std::vector<std::string> ComposedPrograms();
// A part's participant. `common`: domain, mode, seed, log and composition. `stop` outlives it.
// Throws UsageError for a program that cannot be composed or a configuration; DdsError.
std::unique_ptr<node::Component> MakePart(const Part& part, const node::Options& common,
                                          node::StopFlag& stop);

class Chain final : public provider::ComposedCycle {
 public:
  // `common`: domain, mode, seed and log of all. Throws UsageError for a program that cannot be
  // composed, two parts of one name, or a configuration; DdsError.
  Chain(const node::Options& common, node::StopFlag& stop, const std::vector<Part>& parts);

  node::Composition& composition() { return composition_; }
  void Answer() override;
  void Finish() override;

 private:
  using Components = std::vector<std::unique_ptr<node::Component>>;
  static void StepAll(Components* components);

  node::Composition composition_;
  Components before_command_, after_command_;
};

}  // namespace sinew::compose
