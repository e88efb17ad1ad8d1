// Messages as JSON, for people and other programs.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "components/recording/cdr.h"

namespace sinew::recording {

// Enums become their labels; numbers that are not finite become the texts "NaN", "Infinity",
// "-Infinity". Throws CdrError.
nlohmann::ordered_json CdrToJson(const IdlType& type, std::span<const std::byte> payload);

// The reverse, little-endian. Members left out are 0 or empty; arrays may be given shorter than
// they are. Throws CdrError naming the member when a value does not fit or is not known.
Bytes JsonToCdr(const IdlType& type, const nlohmann::ordered_json& json);

}  // namespace sinew::recording
