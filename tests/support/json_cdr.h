// JSON as the payload of a message: the reverse of CdrToJson
// (components/record/recording/file/cdr_json.h).
#pragma once

#include <nlohmann/json.hpp>

#include "components/record/recording/cdr.h"

namespace sinew::recording {

// Little-endian. Members left out are 0 or empty; arrays may be given shorter than they are. Throws
// CdrError naming the member when a value does not fit or is not known.
Bytes JsonToCdr(const IdlType& type, const nlohmann::ordered_json& json);

}  // namespace sinew::recording
