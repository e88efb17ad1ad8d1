#include "components/robot/estop/watch.h"

namespace sinew::estop {

Watch::Watch(const std::vector<std::string>& required, std::int64_t begin_ns) {
  for (const std::string& name : required) estops_.push_back({name, begin_ns, ""});
}

void Watch::Hear(std::string_view name, bool stops, std::string_view why, std::int64_t now_ns) {
  for (Estop& estop : estops_) {
    if (estop.name != name) continue;
    estop.heard_ns = now_ns;
    estop.stopping = stops ? why.empty() ? "stops" : why : "";
  }
}

std::string Watch::Problem(std::int64_t now_ns) const {
  for (const Estop& estop : estops_) {
    const std::int64_t age_ns = now_ns - estop.heard_ns;
    if (age_ns > kLost_ns) {
      return "estop '" + estop.name + "' is silent for " + std::to_string(age_ns / 1'000'000) +
             " ms, limit " + std::to_string(kLost_ns / 1'000'000) +
             " ms: is sinew-estop alive ('sinew list')?";
    }
    if (!estop.stopping.empty()) return "estop '" + estop.name + "': " + estop.stopping;
  }
  return "";
}

}  // namespace sinew::estop
