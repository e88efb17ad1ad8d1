// JSON as text. Names of files and texts of others are bytes, JSON is UTF-8: what is none stands
// there as U+FFFD, instead of an exception at the end of the work.
#pragma once

#include <string>

namespace sinew::types {

// Json: nlohmann's. indent: blanks of a level; -1: one line.
template <class Json>
std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sinew::types
