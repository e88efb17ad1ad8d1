// Do the recordings contain enough rows and blocks for the torque balance? The limits are those of
// rules.h. Pure.
#pragma once

#include <optional>
#include <string>

#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

// The lack of data that a rule finds.
struct TooLittle {
  std::string rule;  // of rules.h
  double statistic = 0.0, limit = 0.0;
  std::string reason;  // one sentence
};

// The first rule that is broken; nothing: there is enough. train, held-out: raw rows.
std::optional<TooLittle> FindTooLittle(const identify::Design& train,
                                       const identify::Design& held_out,
                                       const actuator::JointModel& model, const InForce& in_force);

}  // namespace sinew::trace
