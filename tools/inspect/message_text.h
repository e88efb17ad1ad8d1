// Messages as JSON for people: of joint arrays only the entries that are used. Names of fields.
// Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "components/record/recording/cdr.h"

namespace sinew::inspect {

// As recording::CdrToJson, but in a struct with a member joint_count every array of kMaxJoints
// entries is cut to that many (a count above it cuts nothing). Throws CdrError.
nlohmann::ordered_json MessageJson(const recording::IdlType& type,
                                   std::span<const std::byte> payload);

// "joint_state.position_rad[0]" in two parts; field empty: there is no dot, or nothing behind it.
struct TopicField {
  std::string topic, field;
};
TopicField SplitField(const std::string& text);

}  // namespace sinew::inspect
