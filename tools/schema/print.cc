#include "tools/schema/print.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "components/base/types/joined.h"

namespace sinew::schema {

namespace {

using config::Condition;
using config::FieldInfo;
using config::Shape;
using Json = nlohmann::ordered_json;

// Whole numbers without a point.
void AddBound(const char* key, double bound, Json* value) {
  if (!std::isfinite(bound)) return;
  const bool whole = bound == std::floor(bound) && std::abs(bound) < 1e15;
  (*value)[key] = whole ? Json(static_cast<std::int64_t>(bound)) : Json(bound);
}

void AddRange(const FieldInfo& field, Json* value) {
  const bool positive = field.range.lower == config::kPositive.lower;
  AddBound(positive ? "exclusiveMinimum" : "minimum", positive ? 0.0 : field.range.lower, value);
  AddBound("maximum", field.range.upper, value);
}

Json ValueSchema(const FieldInfo& field) {
  Json value;
  if (field.entries != nullptr) {
    value = JsonSchema(*field.entries);
    if (field.or_number) value = Json{{"anyOf", {Json{{"type", "number"}}, value}}};
  } else if (!field.words.empty()) {
    value["enum"] = field.words;
  } else if (field.type == "string") {
    value["type"] = {"string", "number", "boolean"};  // any scalar is a text
  } else {
    value["type"] = field.type;
  }
  AddRange(field, &value);
  if (field.list) {
    value = Json{{"type", "array"}, {"items", value}};
    AddBound("minItems", field.count.lower, &value);
    AddBound("maxItems", field.count.upper, &value);
  }
  if (!field.help.empty()) value["description"] = field.help;
  if (field.fallback.empty()) return value;
  const Json fallback = Json::parse(field.fallback, nullptr, false);
  value["default"] = fallback.is_discarded() ? Json(field.fallback) : fallback;
  return value;
}

bool IsDefault(const Shape& shape, const Condition& when) {
  return std::any_of(shape.fields.begin(), shape.fields.end(), [&](const FieldInfo& field) {
    return field.keys[0] == when.key &&
           std::count(when.words.begin(), when.words.end(), field.fallback) > 0;
  });
}

// Holds where all conditions do; of two on a choice the inner one has fewer words.
Json If(const Shape& shape, const std::vector<Condition>& when) {
  Json all{{"properties", Json::object()}};
  std::set<std::string> needed;
  for (const Condition& one : when) {
    all["properties"][one.key]["enum"] = one.words;
    if (!IsDefault(shape, one)) needed.insert(one.key);
  }
  if (!needed.empty()) all["required"] = needed;
  return all;
}

Json Needed(const FieldInfo& field) {
  if (field.keys.size() == 1) return {{"required", field.keys}};
  Json any;
  for (const std::string& key : field.keys) any.push_back({{"required", {key}}});
  return {{"anyOf", any}};
}

// The keys that are known with this word of a choice.
std::vector<std::string> KnownWith(const Shape& shape, const std::string& choice,
                                   const std::string& word) {
  std::vector<std::string> known;
  for (const FieldInfo& field : shape.fields) {
    const bool possible =
        std::all_of(field.when.begin(), field.when.end(), [&](const Condition& when) {
          return when.key != choice || std::count(when.words.begin(), when.words.end(), word) > 0;
        });
    if (possible) known.insert(known.end(), field.keys.begin(), field.keys.end());
  }
  return known;
}

std::string Code(const std::string& text) { return "`" + text + "`"; }

std::string RangeText(const FieldInfo& field) {
  std::ostringstream out;
  if (field.range.lower == config::kPositive.lower) {
    out << "> 0";
  } else if (std::isfinite(field.range.lower) && std::isfinite(field.range.upper)) {
    out << field.range.lower << " to " << field.range.upper;
  } else if (std::isfinite(field.range.lower)) {
    out << ">= " << field.range.lower;
  }
  std::string text = out.str();
  for (const std::string& word : field.words) text += (text.empty() ? "" : ", ") + Code(word);
  return text;
}

void AddRows(const Shape& shape, const std::string& prefix, std::string* out) {
  for (const FieldInfo& field : shape.fields) {
    std::vector<std::string> keys, only;
    keys.reserve(field.keys.size());
    for (const std::string& key : field.keys) keys.push_back(Code(prefix + key));
    for (const Condition& when : field.when) {
      only.push_back(Code(when.key) + " " + types::Joined(when.words));
    }
    *out += "| " + types::Joined(keys, " or ") + " | " +
            (field.needed ? "required" : field.fallback) + " | " + RangeText(field) + " | " +
            field.help + (only.empty() ? "" : " (" + types::Joined(only) + ")") + " |\n";
    if (field.entries != nullptr) {
      AddRows(*field.entries, prefix + field.keys[0] + (field.list ? "[]." : "."), out);
    }
  }
}

}  // namespace

Json JsonSchema(const Shape& shape) {
  Json schema{{"type", "object"}, {"additionalProperties", false}, {"properties", nullptr}};
  Json properties = Json::object();
  std::set<std::string> choices;
  for (const FieldInfo& field : shape.fields) {
    const Json value = ValueSchema(field);
    for (const std::string& key : field.keys) {
      if (!properties.contains(key)) {
        properties[key] = value;
      } else if (properties[key] != value) {  // another one with another word
        properties[key] = Json{{"anyOf", {properties[key], value}}};
      }
    }
    for (const Condition& when : field.when) choices.insert(when.key);
    if (field.needed && field.when.empty() && field.keys.size() == 1) {
      schema["required"].push_back(field.keys[0]);
    } else if (field.needed) {
      schema["allOf"].push_back({{"if", If(shape, field.when)}, {"then", Needed(field)}});
    }
  }
  schema["properties"] = std::move(properties);
  for (const FieldInfo& field : shape.fields) {
    if (!choices.contains(field.keys[0])) continue;
    for (const std::string& word : field.words) {
      schema["allOf"].push_back(
          {{"if", If(shape, {{field.keys[0], {word}}})},
           {"then", {{"propertyNames", {{"enum", KnownWith(shape, field.keys[0], word)}}}}}});
    }
  }
  return schema;
}

std::string KeyTable(const Shape& shape) {
  std::string out = "| key | default | range | meaning |\n| --- | --- | --- | --- |\n";
  AddRows(shape, "", &out);
  return out;
}

}  // namespace sinew::schema
