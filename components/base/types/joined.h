// Words in one text.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace sinew::types {

// of: the word of an item. Empty when there are no words.
template <class Items, class Of = std::identity>
std::string Joined(const Items& items, std::string_view separator = ", ", Of of = {}) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text += separator;
    text += std::invoke(of, item);
  }
  return text;
}

}  // namespace sinew::types
