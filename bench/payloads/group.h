// The participants under test: the programs' own classes, made as in their main(), in a composition
// apart (components/topics/node/composition.h).
//
// A group has one participant a role, as a robot has: two of one role would stand by for each
// other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/topics/node/component.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/options.h"

namespace sinew::payloads {

// A property that does not hold; a participant ends with it as with any exception.
class Violation : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What a member needs to be made; outlives it.
struct Environment {
  node::Composition composition{node::Composition::Reach::kApart};
  node::StopFlag stop;
  std::uint64_t tick = 0;                    // of the cycle
  std::uint64_t provider_session = 0x5EED1;  // of the member that is a state provider
};

struct MemberSpec {
  std::string name;
  std::function<std::unique_ptr<node::Component>(const node::Options&, Environment&)> make;
  std::filesystem::path config;
  std::string kind;  // component; the name when empty
};

struct Group {
  std::string name;
  std::vector<MemberSpec> members;
};

// `folder`: bench/payloads; `rig`: robots/rig.
std::vector<Group> AllGroups(const std::filesystem::path& folder, const std::filesystem::path& rig);

std::unique_ptr<node::Component> Make(const MemberSpec& spec, Environment& environment);

}  // namespace sinew::payloads
