#include "tests/support/json_cdr.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "components/record/recording/bytes.h"

namespace sinew::recording {
namespace {

using Json = nlohmann::ordered_json;
using Kind = IdlType::Kind;

void Align(Bytes* out, std::size_t size) {
  out->resize(4 + (out->size() - 4 + size - 1) / size * size);
}

template <class T>
void PutNumber(Bytes* out, T value) {
  Align(out, sizeof(T));
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  out->insert(out->end(), first, first + sizeof(T));
}

template <class T>
void PutInteger(Bytes* out, const Json& json, const std::string& path) {
  const bool is_bool = json.is_boolean();
  if (!json.is_number_integer() && !is_bool)
    throw CdrError("member '" + path + "': expected a whole number");
  bool fits = true;
  T value{};
  if (is_bool) {
    value = json.get<bool>() ? 1 : 0;
  } else if (json.is_number_unsigned()) {
    const auto wide = json.get<std::uint64_t>();
    fits = wide <= static_cast<std::uint64_t>(std::numeric_limits<T>::max());
    value = static_cast<T>(wide);
  } else {
    const auto wide = json.get<std::int64_t>();
    fits = wide >= 0 ? static_cast<std::uint64_t>(wide) <=
                           static_cast<std::uint64_t>(std::numeric_limits<T>::max())
                     : wide >= static_cast<std::int64_t>(std::numeric_limits<T>::min());
    value = static_cast<T>(wide);
  }
  if (!fits) throw CdrError("member '" + path + "': " + json.dump() + " does not fit");
  PutNumber(out, value);
}

double GetReal(const Json& json, const std::string& path) {
  if (json.is_number()) return json.get<double>();
  if (json == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (json == "Infinity") return std::numeric_limits<double>::infinity();
  if (json == "-Infinity") return -std::numeric_limits<double>::infinity();
  throw CdrError("member '" + path + "': expected a number");
}

void Encode(const IdlType& type, const Json& json, const std::string& path, Bytes* out);

void EncodeZero(const IdlType& type, const std::string& path, Bytes* out) {
  switch (type.kind) {
    case Kind::kStruct:
      return Encode(type, Json::object(), path, out);
    case Kind::kArray:
    case Kind::kSequence:
      return Encode(type, Json::array(), path, out);
    case Kind::kString:
      return Encode(type, "", path, out);
    default:
      return Encode(type, 0, path, out);
  }
}

void Encode(const IdlType& type, const Json& json, const std::string& path, Bytes* out) {
  switch (type.kind) {
    case Kind::kBool:
    case Kind::kOctet:
      return PutInteger<std::uint8_t>(out, json, path);
    case Kind::kChar:
      return PutInteger<std::int8_t>(out, json, path);
    case Kind::kInt16:
      return PutInteger<std::int16_t>(out, json, path);
    case Kind::kUint16:
      return PutInteger<std::uint16_t>(out, json, path);
    case Kind::kInt32:
      return PutInteger<std::int32_t>(out, json, path);
    case Kind::kUint32:
      return PutInteger<std::uint32_t>(out, json, path);
    case Kind::kInt64:
      return PutInteger<std::int64_t>(out, json, path);
    case Kind::kUint64:
      return PutInteger<std::uint64_t>(out, json, path);
    case Kind::kFloat:
      return PutNumber(out, static_cast<float>(GetReal(json, path)));
    case Kind::kDouble:
      return PutNumber(out, GetReal(json, path));
    case Kind::kEnum: {
      if (!json.is_string()) return PutInteger<std::uint32_t>(out, json, path);
      const auto label = json.get<std::string>();
      const auto found = std::find(type.enumerators.begin(), type.enumerators.end(), label);
      if (found == type.enumerators.end())
        throw CdrError("member '" + path + "': no label '" + label + "'");
      return PutNumber(out, static_cast<std::uint32_t>(found - type.enumerators.begin()));
    }
    case Kind::kString: {
      if (!json.is_string()) throw CdrError("member '" + path + "': expected a text");
      const auto text = json.get<std::string>();
      if (type.bound != 0 && text.size() > type.bound) {
        throw CdrError("member '" + path + "': expected at most " + std::to_string(type.bound) +
                       " bytes");
      }
      PutNumber(out, static_cast<std::uint32_t>(text.size() + 1));
      PutRaw(out, text);
      out->push_back(std::byte{0});
      return;
    }
    case Kind::kStruct: {
      if (!json.is_object()) throw CdrError("member '" + path + "': expected an object");
      const std::string prefix = path.empty() ? "" : path + ".";
      for (const auto& [key, value] : json.items()) {
        const bool known =
            std::any_of(type.members.begin(), type.members.end(),
                        [&key = key](const IdlMember& member) { return member.name == key; });
        if (!known) throw CdrError("member '" + prefix + key + "' is not known in " + type.name);
      }
      for (const IdlMember& member : type.members) {
        const auto found = json.find(member.name);
        if (found == json.end()) {
          EncodeZero(*member.type, prefix + member.name, out);
        } else {
          Encode(*member.type, *found, prefix + member.name, out);
        }
      }
      return;
    }
    case Kind::kArray:
    case Kind::kSequence: {
      if (!json.is_array()) throw CdrError("member '" + path + "': expected a list");
      if (type.bound != 0 && json.size() > type.bound) {
        throw CdrError("member '" + path + "': expected at most " + std::to_string(type.bound) +
                       " elements");
      }
      const bool sequence = type.kind == Kind::kSequence;
      if (sequence) PutNumber(out, static_cast<std::uint32_t>(json.size()));
      const std::size_t count = sequence ? json.size() : type.bound;
      for (std::size_t i = 0; i < count; ++i) {
        const std::string element = path + "[" + std::to_string(i) + "]";
        if (i < json.size()) {
          Encode(*type.element, json[i], element, out);
        } else {
          EncodeZero(*type.element, element, out);
        }
      }
      return;
    }
  }
}

}  // namespace

Bytes JsonToCdr(const IdlType& type, const nlohmann::ordered_json& json) {
  Bytes out = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  Encode(type, json, "", &out);
  return out;
}

}  // namespace sinew::recording
