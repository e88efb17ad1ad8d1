// The known word that a mistyped one may have meant, and a message that names it. Set-up only.
#pragma once

#include <string>
#include <vector>

namespace sinew::types {

// "; did you mean 'list'?" with the nearest known word; empty where none is near: a letter may be
// wrong, and one more for each three.
std::string DidYouMean(const std::string& word, const std::vector<std::string>& known);
// "no topic 'imus', expected one of: imu, regime; did you mean 'imu'?"
std::string NoSuch(const std::string& what, const std::string& word,
                   const std::vector<std::string>& known);

}  // namespace sinew::types
