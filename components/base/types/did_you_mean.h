// The known word that a mistyped one may have meant.
#pragma once

#include <string>
#include <vector>

namespace sinew::types {

// "; did you mean 'list'?" with the nearest known word; empty where none is near: a letter may be
// wrong, and one more for each three.
std::string DidYouMean(const std::string& word, const std::vector<std::string>& known);

}  // namespace sinew::types
