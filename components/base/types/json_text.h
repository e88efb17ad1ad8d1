// JSON as text, and text as JSON. Names of files and texts of others are bytes, JSON is UTF-8: what
// is none stands there as U+FFFD, instead of an exception at the end of the work.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sinew::types {

// Levels of lists and objects inside each other that a text may have: what writes JSON calls itself
// for each of them, and no file of ours has ten.
inline constexpr int kDeepestJson = 100;

// Json: nlohmann's. indent: blanks of a level; -1: one line.
template <class Json>
std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// "NAME:LINE: "; nothing without a name.
inline std::string PlaceInText(std::string_view text, const std::string& name, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return name.empty() ? ""
                      : name + ":" + std::to_string(1 + std::count(text.begin(), end, '\n')) + ": ";
}

// Json: nlohmann's. name: of the file. deepest: levels, 0: a number or a text alone. Throws
// std::invalid_argument, "NAME:LINE: no valid JSON".
template <class Json>
Json ParseJson(std::string_view text, const std::string& name, int deepest = kDeepestJson) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"') in_text = !in_text;
    if (in_text) {
      if (letter == '\\') ++i;
      continue;
    }
    if (letter == '}' || letter == ']') --depth;
    if ((letter == '{' || letter == '[') && ++depth > deepest) {
      throw std::invalid_argument(PlaceInText(text, name, i) + "JSON of more than " +
                                  std::to_string(deepest) + " levels");
    }
  }
  try {
    return Json::parse(text);
  } catch (const typename Json::parse_error& error) {
    throw std::invalid_argument(PlaceInText(text, name, error.byte) + "no valid JSON");
  } catch (const typename Json::exception&) {  // a number that no double has
    throw std::invalid_argument((name.empty() ? "" : name + ": ") + "no valid JSON");
  }
}

}  // namespace sinew::types
