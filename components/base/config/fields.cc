#include "components/base/config/fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "components/base/types/joined.h"

namespace sinew::config {

namespace {

std::string Text(double value) {
  if (!std::isfinite(value)) return "";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <class T, class Format>
std::string ListText(const std::vector<T>& values, Format format) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const T& value : values) texts.push_back(format(value));
  return values.empty() ? "" : "[" + types::Joined(texts) + "]";
}

std::string Quoted(const std::string& text) { return text.empty() ? "" : "\"" + text + "\""; }

// "speed_rad_s" in the units of a linear joint: speed_m_s.
std::string LinearKey(std::string_view key) {
  std::string out;
  for (std::size_t at = 0; at <= key.size();) {
    const std::size_t end = std::min(key.find('_', at), key.size());
    const std::string_view part = key.substr(at, end - at);
    out += (at == 0 ? "" : "_") + std::string(part == "rad" ? "m" : part == "Nm" ? "N" : part);
    at = end + 1;
  }
  return out;
}

}  // namespace

std::string Fields::Key(std::string_view key) const {
  if (!key.starts_with('~')) return std::string(key);
  return linear_ ? LinearKey(key.substr(1)) : std::string(key.substr(1));
}

FieldInfo& Fields::Add(const Field& field, const char* type, const std::string& fallback) {
  FieldInfo info{.keys = {Key(field.key)}, .type = type, .help = std::string(field.help)};
  if (field.key.starts_with('~')) info.keys = {info.keys[0], LinearKey(info.keys[0])};
  info.range = field.range;
  info.needed = field.needed;
  if (!field.needed && !std::exchange(optional_, false)) info.fallback = fallback;
  info.when = shape_->open;
  return shape_->fields.emplace_back(std::move(info));
}

bool Fields::Reads(const Field& field, const char* type, const std::string& fallback, bool list) {
  if (reads()) return field.needed || section_->Has(Key(field.key));
  Add(field, type, fallback).list = list;
  return false;
}

void Fields::Leaf(const Field& field, double& value) {
  if (Reads(field, "number", Text(value))) value = section_->Number(Key(field.key), field.range);
}

void Fields::Leaf(const Field& field, std::int64_t& value) {
  if (!Reads(field, "integer", std::to_string(value))) return;
  value = section_->Integer(Key(field.key), field.range);
}

void Fields::Leaf(const Field& field, bool& value) {
  if (!Reads(field, "boolean", value ? "true" : "false")) return;
  if (!section_->Has(field.key)) Fail(field.key, "missing, expected true or false");
  value = section_->BoolOr(field.key, value);
}

void Fields::Leaf(const Field& field, std::string& value) {
  if (Reads(field, "string", Quoted(value))) value = section_->Text(field.key);
}

void Fields::Leaf(const Field& field, std::filesystem::path& value) {
  if (Reads(field, "string", "")) value = section_->ExistingPath(field.key);
}

void Fields::Leaf(const Field& field, std::vector<double>& value) {
  if (!Reads(field, "number", ListText(value, Text), true)) return;
  value = section_->Numbers(field.key, field.range);
}

void Fields::Leaf(const Field& field, std::vector<std::int64_t>& value) {
  if (!Reads(field, "integer", "", true)) return;
  value = section_->Integers(field.key, field.range);
}

void Fields::Leaf(const Field& field, std::vector<std::string>& value) {
  if (!Reads(field, "string", ListText(value, Quoted), true)) return;
  if (!section_->Has(field.key)) Fail(field.key, "missing, expected a list of texts");
  value = section_->TextsOr(field.key, {});
}

void Fields::Leaf(const Field& field, std::array<double, 3>& value) {
  std::vector<double> numbers(value.begin(), value.end());
  const std::size_t before = reads() ? 0 : shape_->fields.size();
  Leaf(field, numbers);
  if (!reads()) shape_->fields[before].count = {3.0, 3.0};
  if (numbers.size() != value.size()) {
    Fail(field.key,
         "has " + std::to_string(numbers.size()) + " numbers, expected " +
             (field.key.find("rpy") < field.key.size() ? "3: roll, pitch, yaw" : "x, y, z"));
  }
  std::copy(numbers.begin(), numbers.end(), value.begin());
}

void Fields::Leaf(const Field& field, Numbers& value) {
  if (!Reads(field, "object", "")) return;
  const Section numbers = section_->Child(field.key);
  for (const std::string& key : numbers.Keys()) value.emplace_back(key, numbers.Number(key));
}

void Fields::NumberOr(std::string_view key, double& value, Range range, std::string_view help,
                      const Body& body, bool needed) {
  if (!reads()) {
    const std::size_t at = shape_->fields.size();
    Nest({key, {}, help, needed}, body);
    shape_->fields[at].or_number = true;
  } else if (section_->IsScalar(key)) {
    value = section_->Number(key, range);
  } else if (needed || section_->Has(key)) {
    Nest({key, {}, help, true}, body);
  }
}

void Fields::PathOr(std::string_view key, std::filesystem::path& path,
                    const std::filesystem::path& given, std::string_view help, bool needed) {
  std::string own;
  if (given.empty()) return Leaf({key, {}, help, needed}, path);
  Leaf({key, {}, help, needed}, own);
  path = given;
}

void Fields::Others(std::initializer_list<const char*> keys) const {
  for (const char* key : keys) {
    if (reads()) section_->Has(key);
  }
}

void Fields::Milliseconds(std::string_view key, double& time_s, Range range_ms,
                          std::string_view help) {
  double time_ms = 1e3 * time_s;
  Leaf({key, range_ms, help, false}, time_ms);
  if (reads()) time_s = 1e-3 * time_ms;
}

Fields::Choice Fields::Choose(const Field& field, const std::string& word,
                              std::vector<std::string> words) {
  Choice choice{shape_.get(), std::string(field.key), word};
  if (!reads()) {
    Add(field, "string", word).words = std::move(words);
  } else if (field.needed || section_->Has(field.key)) {
    choice.word = section_->Choice(field.key, words);
  }
  return choice;
}

Fields::Case Fields::Choice::Is(std::vector<std::string> words) const {
  const bool holds = std::find(words.begin(), words.end(), word) != words.end();
  if (shape != nullptr) shape->open.push_back({key, std::move(words)});
  return {shape, shape != nullptr || holds};
}

void Fields::Enter(Section section, const Body& body) const {
  Fields inner(std::move(section));
  inner.linear_ = linear_;
  body(inner);
  inner.section_->RejectUnknownKeys();
}

void Fields::Nest(const Field& field, const Body& body) {
  if (reads()) {
    return Enter(field.needed ? section_->Child(field.key) : section_->ChildOrEmpty(field.key),
                 body);
  }
  Fields inner(Add(field, "object", "").entries = std::make_shared<Shape>());
  body(inner);
}

bool Fields::If(std::string_view key, std::string_view help, const Body& body) {
  const bool there = !reads() || section_->Has(key);
  if (there) Nest({key, {}, help, false}, body);
  return there;
}

void Fields::ForEach(const Field& field, const Body& body) {
  if (!reads()) {
    FieldInfo& info = Add(field, "object", "");
    info.list = true;
    info.count = std::exchange(info.range, {});
    Fields inner(info.entries = std::make_shared<Shape>());
    return body(inner);
  }
  if (!field.needed && !section_->Has(field.key)) return;
  const std::vector<Section> entries = section_->List(field.key);
  const double count = static_cast<double>(entries.size());
  if (count < field.range.lower || count > field.range.upper) {
    Fail(field.key, "has " + std::to_string(entries.size()) + " entries, expected " +
                        Text(field.range.lower) +
                        (std::isfinite(field.range.upper) ? " to " + Text(field.range.upper)
                                                          : std::string(" or more")));
  }
  for (const Section& entry : entries) Enter(entry, body);
}

void Fields::Require(bool holds, std::string_view key, const std::string& message) const {
  if (!reads() || holds) return;
  section_->RejectUnknownKeys();
  Fail(key, message);
}

void Fields::Check(std::string_view key, const std::function<void()>& body) const {
  if (!reads()) return;
  section_->RejectUnknownKeys();
  try {
    body();
  } catch (const std::invalid_argument& error) {
    Fail(key, error.what());
  }
}

}  // namespace sinew::config
