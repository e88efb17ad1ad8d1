// A configuration described once. The function
//
//   void Describe(config::Fields& f, RelayTimes& c) {
//     f("min_on_s", c.min_on_s, kNotNegative, "least time on");
//   }
//
// names key (with its unit), range, default (what the member holds) and a line of help. Reading,
// Fields takes the values from a Section, with its one-line errors; describing, it adds them to a
// Shape, of which tools/schema makes JSON schemas and the tables of the documents, and leaves the
// members as they are. A key "~speed_rad_s" has the units of the joint's kind: speed_m_s where it
// is linear. Throws UsageError. Set-up only; thread: one.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/base/config/config.h"

namespace sinew::config {

struct Shape;
using Numbers = std::vector<std::pair<std::string, double>>;  // a mapping with any keys

// Words of a choice that make a key known: all of them have to hold.
struct Condition {
  std::string key;
  std::vector<std::string> words;
};

struct FieldInfo {
  std::vector<std::string> keys;  // two: of a rotary and of a linear joint
  std::string type;               // as in JSON schemas: number, integer, boolean, string, object
  std::string help;
  Range range{};
  bool needed = false;
  std::string fallback{};            // as YAML; empty: none
  std::vector<std::string> words{};  // allowed ones; empty: any
  std::vector<Condition> when{};
  bool list = false;
  bool or_number = false;            // beside an object
  Range count{};                     // of a list
  std::shared_ptr<Shape> entries{};  // of an object; nullptr: any keys
};

// The keys of a mapping, in the order of their description.
struct Shape {
  std::vector<FieldInfo> fields;
  std::vector<Condition> open;  // while it is described
};

class Fields {
 public:
  explicit Fields(Section section) : section_(std::move(section)) {}
  explicit Fields(std::shared_ptr<Shape> shape) : shape_(std::move(shape)) {}

  bool reads() const { return shape_ == nullptr; }
  const Section& section() const { return *section_; }  // reads() only
  bool linear() const { return linear_; }
  void set_linear(bool linear) { linear_ = linear; }  // units of the keys with ~, below as well

  // A key that is left out leaves its value as it is, an optional value empty. Value: a number,
  // text, path (that exists), list of these, a struct with a Describe, or a list of structs, whose
  // range is the number of entries.
  template <class T>
  void operator()(std::string_view key, T&& value, Range range, std::string_view help) {
    Visit({key, range, help, false}, value);
  }
  template <class T>
  void operator()(std::string_view key, T&& value, std::string_view help) {
    Visit({key, {}, help, false}, value);
  }
  // The same, to be there.
  template <class T>
  void Need(std::string_view key, T&& value, Range range, std::string_view help) {
    Visit({key, range, help, true}, value);
  }
  template <class T>
  void Need(std::string_view key, T&& value, std::string_view help) {
    Visit({key, {}, help, true}, value);
  }
  // The body describes the keys of the mapping: of defaults where it is left out, as one that has
  // to be there, or of one that is read where it is there only (returns whether it is); for each
  // entry of a list.
  using Body = std::function<void(Fields&)>;
  void Object(std::string_view key, std::string_view help, const Body& body) {
    Nest({key, {}, help, false}, body);
  }
  void NeedObject(std::string_view key, std::string_view help, const Body& body) {
    Nest({key, {}, help, true}, body);
  }
  bool If(std::string_view key, std::string_view help, const Body& body);
  void List(std::string_view key, Range count, std::string_view help, const Body& body) {
    ForEach({key, count, help, false}, body);
  }
  void NeedList(std::string_view key, Range count, std::string_view help, const Body& body) {
    ForEach({key, count, help, true}, body);
  }
  // A number, or a mapping that the body describes.
  void NumberOr(std::string_view key, double& value, Range range, std::string_view help,
                const Body& body, bool needed = true);
  // A path, or `given` in its place where that is not empty: the file's own need not exist then.
  void PathOr(std::string_view key, std::filesystem::path& path, const std::filesystem::path& given,
              std::string_view help, bool needed = false);
  // Keys that another part of the program reads.
  void Others(std::initializer_list<const char*> keys) const;
  // A time that the file states in ms.
  void Milliseconds(std::string_view key, double& time_s, Range range_ms, std::string_view help);

  // Keys below the guard are known when the word is one of these.
  class Case {
   public:
    Case(Shape* shape, bool holds) : shape_(shape), holds_(holds) {}
    Case(const Case&) = delete;
    Case& operator=(const Case&) = delete;
    ~Case() {
      if (shape_ != nullptr) shape_->open.pop_back();
    }
    explicit operator bool() const { return holds_; }

   private:
    Shape* shape_;
    bool holds_;
  };
  struct Choice {
    Shape* shape;
    std::string key, word;
    Case Is(std::vector<std::string> words) const;
  };
  template <class T>
  using Words = std::initializer_list<std::pair<const char*, std::type_identity_t<T>>>;
  template <class T>
  Choice Word(std::string_view key, T& value, Words<T> words, std::string_view help,
              bool needed = false) {
    std::vector<std::string> names;
    std::string word;
    for (const auto& [name, meaning] : words) {
      names.emplace_back(name);
      if (meaning == value && word.empty()) word = name;
    }
    Choice choice = Choose({key, {}, help, needed}, word, std::move(names));
    for (const auto& [name, meaning] : words) {
      if (choice.word == name) value = meaning;
    }
    return choice;
  }
  template <class T>
  Choice NeedWord(std::string_view key, T& value, Words<T> words, std::string_view help) {
    return Word(key, value, words, help, true);
  }
  Choice NeedWord(std::string_view key, std::vector<std::string> words, std::string_view help) {
    return Choose({key, {}, help, true}, words.front(), words);
  }

  // Checks that span keys, when reading, after the last key: unknown ones are refused first, as a
  // mistyped one has its default.
  void Require(bool holds, std::string_view key, const std::string& message) const;
  // A std::invalid_argument that the body throws is an error of the key.
  void Check(std::string_view key, const std::function<void()>& body) const;
  [[noreturn]] void Fail(std::string_view key, const std::string& message) const {
    section_->Fail(Key(key), message);
  }
  std::string Key(std::string_view key) const;  // with the units of the joint's kind

 private:
  struct Field {
    std::string_view key;
    Range range;
    std::string_view help;
    bool needed;
  };

  template <class T>
  void Visit(const Field& field, T& value) {
    if constexpr (requires { Leaf(field, value); }) {
      Leaf(field, value);
    } else if constexpr (std::integral<T>) {
      auto whole = static_cast<std::int64_t>(value);
      Leaf(field, whole);
      value = static_cast<T>(whole);
    } else if constexpr (requires { value.emplace(); }) {
      if (reads() && !section_->Has(Key(field.key))) return;
      typename T::value_type inner{};
      optional_ = true;  // the default of the inner value is none
      Visit(field, inner);
      if (reads()) value = std::move(inner);
    } else if constexpr (requires { value.push_back(value[0]); }) {
      ForEach(field, [&](Fields& f) { Describe(f, value.emplace_back()); });
    } else {
      Nest(field, [&](Fields& f) { Describe(f, value); });
    }
  }
  template <class T>
  void Leaf(const Field&, T&) = delete;
  void Leaf(const Field& field, double& value);
  void Leaf(const Field& field, std::int64_t& value);
  void Leaf(const Field& field, bool& value);
  void Leaf(const Field& field, std::string& value);
  void Leaf(const Field& field, std::filesystem::path& value);
  void Leaf(const Field& field, std::vector<double>& value);
  void Leaf(const Field& field, std::vector<std::int64_t>& value);
  void Leaf(const Field& field, std::vector<std::string>& value);
  void Leaf(const Field& field, std::array<double, 3>& value);
  void Leaf(const Field& field, Numbers& value);

  Choice Choose(const Field& field, const std::string& word, std::vector<std::string> words);
  void Nest(const Field& field, const Body& body);
  void ForEach(const Field& field, const Body& body);
  void Enter(Section section, const Body& body) const;
  // False: left out, or described with this type.
  bool Reads(const Field& field, const char* type, const std::string& fallback, bool list = false);
  FieldInfo& Add(const Field& field, const char* type, const std::string& fallback);

  std::optional<Section> section_;
  std::shared_ptr<Shape> shape_;
  bool linear_ = false;
  bool optional_ = false;
};

// A section as its struct, by Describe(fields, struct, more...); unknown keys are refused.
template <class T, class... More>
T Read(const Section& section, const More&... more) {
  T value{};
  Fields fields(section);
  Describe(fields, value, more...);
  section.RejectUnknownKeys();
  return value;
}

}  // namespace sinew::config
