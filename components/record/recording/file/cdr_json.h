// Messages as JSON, for people and other programs.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "components/record/recording/cdr.h"

namespace sinew::recording {

// Enums become their labels; numbers that are not finite become the texts "NaN", "Infinity",
// "-Infinity". Throws CdrError.
nlohmann::ordered_json CdrToJson(const IdlType& type, std::span<const std::byte> payload);

}  // namespace sinew::recording
