// The flattened IDL text of every topic type, as it was when the types were generated.
#pragma once

#include <string_view>
#include <vector>

namespace sinew::idl {

struct EmbeddedType {
  std::string_view type_name;  // "sinew::msg::JointState"
  std::string_view text;       // its file and all it includes, without #include lines
  std::string_view hash;       // FNV-1a of the text without comments and blanks, 8 hex digits
};

const std::vector<EmbeddedType>& EmbeddedTypes();

}  // namespace sinew::idl
