// Reads flattened IDL, the subset our topics use (idl/README.md), into a tree of types.
//
// Understood: modules, @final structs, enums, primitives, bounded and unbounded strings, sequences,
// fixed arrays of one dimension, nested structs, comments, annotations (those that change the
// encoding -
// @appendable, @mutable, @optional - are refused). Set-up only: allocates.
#pragma once

#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::recording {

// "line 12: ..., expected ..."
class IdlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct IdlType;

struct IdlMember {
  std::string name;
  const IdlType* type = nullptr;
  bool key = false;
};

struct IdlType {
  enum class Kind {
    kBool,
    kOctet,
    kChar,
    kInt16,
    kUint16,
    kInt32,
    kUint32,
    kInt64,
    kUint64,
    kFloat,
    kDouble,
    kEnum,
    kString,
    kStruct,
    kSequence,
    kArray,
  };
  Kind kind{};
  std::string name;                      // scoped, of structs and enums: "sinew::msg::Header"
  std::vector<IdlMember> members;        // kStruct
  std::vector<std::string> enumerators;  // kEnum, values from 0
  const IdlType* element = nullptr;      // kSequence, kArray
  std::uint32_t bound = 0;  // kString, kSequence: at most (0: unbounded); kArray: exactly

  bool is_number() const { return kind <= Kind::kEnum; }
  std::uint32_t size() const;  // bytes of a number, also its alignment; 0 for the rest
};

class IdlSchema {
 public:
  // Throws IdlError.
  static IdlSchema Parse(std::string_view text);
  // Throws IdlError when there is no such struct.
  const IdlType& Struct(std::string_view scoped_name) const;
  // Types in file order, structs and enums.
  const std::vector<const IdlType*>& types() const { return named_; }

 private:
  friend class IdlParser;
  std::deque<IdlType> storage_;  // keeps addresses
  std::vector<const IdlType*> named_;
};

// The text without comments and white space: two schemas with equal bare text have equal types.
std::string BareIdl(std::string_view text);

}  // namespace sinew::recording
