#include "components/record/recording/idl_schema.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace sinew::recording {
namespace {

using Kind = IdlType::Kind;

constexpr std::size_t kMaxDepth = 32;  // schemas come out of files: bounded recursion
constexpr std::uint32_t kMaxArray = 1u << 20;

bool IsWordStart(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool IsWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Length of the comment that starts here; 0: none.
std::size_t CommentLength(std::string_view text) {
  if (text.starts_with("//")) return std::min(text.find('\n'), text.size());
  if (text.starts_with("/*")) {
    const auto end = text.find("*/", 2);
    return end == std::string_view::npos ? text.size() : end + 2;
  }
  return 0;
}

}  // namespace

std::uint32_t IdlType::size() const {
  switch (kind) {
    case Kind::kBool:
    case Kind::kOctet:
    case Kind::kChar:
      return 1;
    case Kind::kInt16:
    case Kind::kUint16:
      return 2;
    case Kind::kInt32:
    case Kind::kUint32:
    case Kind::kFloat:
    case Kind::kEnum:
      return 4;
    case Kind::kInt64:
    case Kind::kUint64:
    case Kind::kDouble:
      return 8;
    default:
      return 0;
  }
}

class IdlParser {
 public:
  explicit IdlParser(std::string_view text) : rest_(text) {}

  IdlSchema Parse() {
    Advance();
    while (!token_.empty()) Definition();
    return std::move(schema_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw IdlError("line " + std::to_string(line_) + ": " + what);
  }
  std::string Found() const {
    return token_.empty() ? "the end of the text" : std::string("'").append(token_).append("'");
  }

  // Next token: a word, a number, "::" or one character; empty at the end.
  void Advance() {
    for (;;) {
      if (rest_.empty()) {
        token_ = {};
        return;
      }
      if (rest_.front() == '\n') ++line_;
      if (std::isspace(static_cast<unsigned char>(rest_.front())) != 0) {
        rest_.remove_prefix(1);
        continue;
      }
      const std::size_t comment = CommentLength(rest_);
      if (comment == 0) break;
      line_ += static_cast<int>(
          std::count(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(comment), '\n'));
      rest_.remove_prefix(comment);
    }
    std::size_t length = 1;
    if (IsWord(rest_.front())) {
      while (length < rest_.size() && IsWord(rest_[length])) ++length;
    } else if (rest_.starts_with("::")) {
      length = 2;
    }
    token_ = rest_.substr(0, length);
    rest_.remove_prefix(length);
  }
  bool Accept(std::string_view token) {
    if (token_ != token) return false;
    Advance();
    return true;
  }
  void Expect(std::string_view token) {
    if (!Accept(token)) Fail("found " + Found() + ", expected '" + std::string(token) + "'");
  }
  std::string Name() {
    if (token_.empty() || !IsWordStart(token_.front()))
      Fail("found " + Found() + ", expected a name");
    std::string name(token_);
    Advance();
    return name;
  }
  std::uint32_t Count() {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(token_.data(), token_.data() + token_.size(), value);
    if (error != std::errc{} || end != token_.data() + token_.size() || value == 0) {
      Fail("found " + Found() + ", expected a number above 0");
    }
    Advance();
    return value;
  }

  // Annotations before a definition or member; says whether @key was among them.
  bool Annotations() {
    bool key = false;
    while (Accept("@")) {
      const std::string name = Name();
      if (name == "optional" || name == "mutable" || name == "appendable" || name == "bit_bound") {
        Fail("annotation @" + name + " changes the encoding, expected @final and @key only");
      }
      key = key || name == "key";
      if (Accept("(")) {
        while (!Accept(")")) {
          if (token_.empty()) Fail("an annotation does not end");
          Advance();
        }
      }
    }
    return key;
  }

  void Definition() {
    Annotations();
    if (Accept("module")) {
      if (scope_.size() == kMaxDepth) Fail("modules are nested too deep");
      scope_.push_back(Name());
      Expect("{");
      while (!Accept("}")) {
        if (token_.empty()) Fail("module '" + scope_.back() + "' does not end");
        Definition();
      }
      scope_.pop_back();
    } else if (Accept("struct")) {
      Struct();
    } else if (Accept("enum")) {
      Enum();
    } else {
      Fail("found " + Found() + ", expected module, struct or enum");
    }
    Expect(";");
  }

  std::string Scoped(const std::string& name, std::size_t depth) const {
    std::string scoped;
    for (std::size_t i = 0; i < depth; ++i) scoped += scope_[i] + "::";
    return scoped + name;
  }
  const IdlType* Find(const std::string& scoped) const {
    for (const IdlType* type : schema_.named_) {
      if (type->name == scoped) return type;
    }
    return nullptr;
  }
  IdlType& Add(Kind kind) {
    schema_.storage_.emplace_back();
    schema_.storage_.back().kind = kind;
    return schema_.storage_.back();
  }

  void Enum() {
    IdlType& type = Add(Kind::kEnum);
    type.name = NewName();
    Expect("{");
    do {
      Annotations();
      type.enumerators.push_back(Name());
    } while (Accept(","));
    Expect("}");
    schema_.named_.push_back(&type);
  }

  std::string NewName() {
    std::string name = Scoped(Name(), scope_.size());
    if (Find(name) != nullptr) Fail("type '" + name + "' is defined twice");
    return name;
  }

  void Struct() {
    IdlType& type = Add(Kind::kStruct);
    type.name = NewName();
    if (token_ == ":") Fail("struct '" + type.name + "' inherits, which our subset has not");
    Expect("{");
    while (!Accept("}")) {
      const bool key = Annotations();
      const IdlType* base = Type();
      do {
        IdlMember member{Name(), base, key};
        for (const IdlMember& other : type.members) {
          if (other.name == member.name) Fail("member '" + member.name + "' is there twice");
        }
        if (Accept("[")) {
          IdlType& array = Add(Kind::kArray);
          array.element = base;
          array.bound = Count();
          if (array.bound > kMaxArray)
            Fail("an array of " + std::to_string(array.bound) + " elements");
          member.type = &array;
          Expect("]");
          if (token_ == "[") Fail("member '" + member.name + "' has two dimensions, expected one");
        }
        type.members.push_back(std::move(member));
      } while (Accept(","));
      Expect(";");
    }
    if (type.members.empty()) Fail("struct '" + type.name + "' has no member");
    schema_.named_.push_back(&type);
  }

  const IdlType* Primitive(Kind kind) {
    for (const IdlType& type : schema_.storage_) {
      if (type.kind == kind && type.name.empty()) return &type;
    }
    return &Add(kind);
  }

  const IdlType* Type(std::size_t depth = 0) {
    if (depth == kMaxDepth) Fail("sequences are nested too deep");
    static constexpr std::array<std::pair<std::string_view, Kind>, 15> kWords = {
        {{"boolean", Kind::kBool},
         {"octet", Kind::kOctet},
         {"uint8", Kind::kOctet},
         {"char", Kind::kChar},
         {"short", Kind::kInt16},
         {"int16", Kind::kInt16},
         {"uint16", Kind::kUint16},
         {"int32", Kind::kInt32},
         {"uint32", Kind::kUint32},
         {"int64", Kind::kInt64},
         {"uint64", Kind::kUint64},
         {"float", Kind::kFloat},
         {"double", Kind::kDouble},
         {"wchar", Kind::kStruct},
         {"wstring", Kind::kStruct}}};
    if (Accept("unsigned")) {
      if (Accept("short")) return Primitive(Kind::kUint16);
      Expect("long");
      return Primitive(Accept("long") ? Kind::kUint64 : Kind::kUint32);
    }
    if (Accept("long")) {
      if (token_ == "double") Fail("type 'long double', which our subset has not");
      return Primitive(Accept("long") ? Kind::kInt64 : Kind::kInt32);
    }
    if (Accept("string")) {
      IdlType& type = Add(Kind::kString);
      if (Accept("<")) {
        type.bound = Count();
        Expect(">");
      }
      return &type;
    }
    if (Accept("sequence")) {
      Expect("<");
      const IdlType* element = Type(depth + 1);
      IdlType& type = Add(Kind::kSequence);
      type.element = element;
      if (Accept(",")) type.bound = Count();
      Expect(">");
      return &type;
    }
    for (const auto& [word, kind] : kWords) {
      if (token_ == word) {
        if (kind == Kind::kStruct)
          Fail("type '" + std::string(word) + "', which our subset has not");
        Advance();
        return Primitive(kind);
      }
    }
    Accept("::");
    std::string name = Name();
    while (Accept("::")) name += "::" + Name();
    for (std::size_t outer = scope_.size() + 1; outer-- > 0;) {
      if (const IdlType* type = Find(Scoped(name, outer))) return type;
    }
    Fail("type '" + name + "' is not known here");
  }

  std::string_view rest_;
  std::string_view token_;
  int line_ = 1;
  std::vector<std::string> scope_;
  IdlSchema schema_;
};

IdlSchema IdlSchema::Parse(std::string_view text) { return IdlParser(text).Parse(); }

const IdlType& IdlSchema::Struct(std::string_view scoped_name) const {
  for (const IdlType* type : named_) {
    if (type->kind == Kind::kStruct && type->name == scoped_name) return *type;
  }
  throw IdlError("no struct '" + std::string(scoped_name) + "' in the schema");
}

std::string BareIdl(std::string_view text) {
  std::string bare;
  while (!text.empty()) {
    const std::size_t comment = CommentLength(text);
    if (comment > 0) {
      text.remove_prefix(comment);
      continue;
    }
    if (std::isspace(static_cast<unsigned char>(text.front())) == 0) bare += text.front();
    text.remove_prefix(1);
  }
  return bare;
}

}  // namespace sinew::recording
