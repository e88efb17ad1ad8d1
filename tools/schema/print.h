// A described configuration for editors and for the documents. Set-up only; thread: one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "components/base/config/fields.h"

namespace sinew::schema {

// JSON schema, draft 7, of the mapping: ranges, words, defaults, and the keys of each word of a
// choice. A value that a reader refuses for several keys together is not refused by it.
nlohmann::ordered_json JsonSchema(const config::Shape& shape);

// Rows of key, default, range and meaning. Keys of mappings in it follow theirs, "limits.upper_rad"
// and of lists "joints[].name".
std::string KeyTable(const config::Shape& shape);

}  // namespace sinew::schema
