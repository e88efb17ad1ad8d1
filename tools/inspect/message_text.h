// Messages as JSON for people: of joint arrays only the entries that are used. Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "components/record/recording/cdr.h"

namespace sinew::inspect {

// As recording::CdrToJson, but in a struct with a member joint_count every array of kMaxJoints
// entries is cut to that many (a count above it cuts nothing). Throws CdrError.
nlohmann::ordered_json MessageJson(const recording::IdlType& type,
                                   std::span<const std::byte> payload);

}  // namespace sinew::inspect
