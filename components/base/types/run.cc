#include "components/base/types/run.h"

#include <stdexcept>

namespace sinew::types {

const Eigen::VectorXd& Run::At(Signal signal) const {
  const auto found = signals.find(signal);
  if (found == signals.end()) {
    throw std::invalid_argument("run '" + name + "' has no signal '" +
                                std::string(SignalName(signal)) + "'");
  }
  return found->second;
}

}  // namespace sinew::types
