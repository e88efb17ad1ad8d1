// Text of others (names and reasons from the network, names and contents of files) as it can be
// shown: without control characters, so that it cannot move a terminal's cursor, clear its screen
// or forge lines; as UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace sinew::types {

enum class Lines {
  kOne,   // a name, a reason: line ends and tabs are replaced, too
  kMany,  // line ends and tabs stay
};

// True for what Printable returns unchanged.
bool IsPrintable(std::string_view text, Lines lines = Lines::kOne);

// Control characters are replaced by what JSON calls them, so that JSON stays JSON: ESC by \u001b,
// a line end by \n. They are those of ASCII and, as UTF-8, of ISO 8859-1 (C1, whose CSI does what
// ESC [ does). All else stays.
std::string Printable(std::string_view text, Lines lines = Lines::kOne);

// The text with U+FFFD for what is no UTF-8: names of files are bytes, and JSON, HTML and MCAP are
// not.
std::string Utf8(std::string_view text);

// The text with the entities of HTML and XML for &, <, > and ".
std::string Entities(std::string_view text);

}  // namespace sinew::types
