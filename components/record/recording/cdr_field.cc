#include <algorithm>
#include <charconv>
#include <cstring>

#include "components/base/types/joined.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/cdr_walker.h"

namespace sinew::recording {
namespace {

using Kind = IdlType::Kind;

// Size of a type whose size never varies, from a position on; nothing when it varies.
std::optional<std::size_t> FixedEnd(const IdlType& type, std::size_t position) {
  const auto aligned = [&position](std::size_t size) {
    return kCdrHeaderSize + (position - kCdrHeaderSize + size - 1) / size * size;
  };
  if (type.is_number()) return aligned(type.size()) + type.size();
  if (type.kind == Kind::kArray && type.element->is_number()) {
    return aligned(type.element->size()) + std::size_t{type.bound} * type.element->size();
  }
  if (type.kind == Kind::kArray) {
    std::optional<std::size_t> end = position;
    for (std::uint32_t i = 0; i < type.bound && end; ++i) end = FixedEnd(*type.element, *end);
    return end;
  }
  if (type.kind == Kind::kStruct) {
    std::optional<std::size_t> end = position;
    for (std::size_t i = 0; i < type.members.size() && end; ++i)
      end = FixedEnd(*type.members[i].type, *end);
    return end;
  }
  return std::nullopt;
}

template <class T>
T Load(std::span<const std::byte> payload, std::size_t at, bool swapped) {
  T value;
  std::memcpy(&value, payload.data() + at, sizeof(T));
  return swapped ? SwapBytes(value) : value;
}

template <class T>
void Store(std::span<std::byte> payload, std::size_t at, bool swapped, T value) {
  if (swapped) value = SwapBytes(value);
  std::memcpy(payload.data() + at, &value, sizeof(T));
}

// Calls visit with a value of the C++ type of a number.
template <class Visit>
auto WithNumber(Kind kind, Visit visit) {
  switch (kind) {
    case Kind::kBool:
    case Kind::kOctet:
      return visit(std::uint8_t{});
    case Kind::kChar:
      return visit(std::int8_t{});
    case Kind::kInt16:
      return visit(std::int16_t{});
    case Kind::kUint16:
      return visit(std::uint16_t{});
    case Kind::kInt32:
      return visit(std::int32_t{});
    case Kind::kUint32:
    case Kind::kEnum:
      return visit(std::uint32_t{});
    case Kind::kInt64:
      return visit(std::int64_t{});
    case Kind::kUint64:
      return visit(std::uint64_t{});
    case Kind::kFloat:
      return visit(float{});
    default:
      return visit(double{});
  }
}

}  // namespace

CdrField::CdrField(const IdlType& type, std::string_view path) : leaf_(&type) {
  const std::string whole(path);
  std::string so_far;
  while (!path.empty()) {
    if (path.front() == '[') {
      const auto end = path.find(']');
      std::uint32_t index = 0;
      const std::string_view digits = path.substr(1, end == std::string_view::npos ? 0 : end - 1);
      const auto [last, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), index);
      if (digits.empty() || error != std::errc{} || last != digits.data() + digits.size()) {
        throw CdrError("path '" + whole + "': expected an index such as [0] after '" + so_far +
                       "'");
      }
      if (leaf_->kind != Kind::kArray && leaf_->kind != Kind::kSequence) {
        throw CdrError("path '" + whole + "': '" + so_far + "' is no list");
      }
      if (leaf_->bound != 0 && index >= leaf_->bound) {
        throw CdrError("path '" + whole + "': index " + std::to_string(index) + " of '" + so_far +
                       "', expected 0 to " + std::to_string(leaf_->bound - 1));
      }
      steps_.push_back({leaf_, index});
      leaf_ = leaf_->element;
      so_far += path.substr(0, end + 1);
      path.remove_prefix(end + 1);
      continue;
    }
    if (path.front() == '.' && !so_far.empty()) path.remove_prefix(1);
    const std::string_view name = path.substr(0, path.find_first_of(".["));
    if (leaf_->kind != Kind::kStruct)
      throw CdrError("path '" + whole + "': '" + so_far + "' has no members");
    const auto member =
        std::find_if(leaf_->members.begin(), leaf_->members.end(),
                     [&](const IdlMember& candidate) { return candidate.name == name; });
    if (member == leaf_->members.end()) {
      throw CdrError("no field '" + std::string(name) + "' in " + leaf_->name +
                     ", expected one of: " + types::Joined(leaf_->members, ", ", &IdlMember::name));
    }
    steps_.push_back({leaf_, static_cast<std::uint32_t>(member - leaf_->members.begin())});
    leaf_ = member->type;
    so_far += (so_far.empty() ? "" : ".") + std::string(name);
    path.remove_prefix(name.size());
  }
  if (!leaf_->is_number() && leaf_->kind != Kind::kString) {
    throw CdrError("path '" + whole + "' ends at a " +
                   (leaf_->kind == Kind::kStruct ? "struct, expected one of its members"
                                                 : "list, expected an index such as [0]"));
  }

  std::size_t offset = kCdrHeaderSize;
  bool fixed = leaf_->is_number();
  for (const Step& step : steps_) {
    fixed = fixed && step.inside->kind != Kind::kSequence;
    for (std::uint32_t i = 0; i < step.index && fixed; ++i) {
      const bool member = step.inside->kind == Kind::kStruct;
      const std::optional<std::size_t> end =
          FixedEnd(member ? *step.inside->members[i].type : *step.inside->element, offset);
      fixed = end.has_value();
      offset = end.value_or(offset);
    }
  }
  if (fixed) fixed_offset_ = FixedEnd(*leaf_, offset).value_or(0) - leaf_->size();
}

std::size_t CdrField::Locate(std::span<const std::byte> payload, bool* swapped) const {
  *swapped = ReadCdrHeader(payload);
  std::size_t at = 0;
  if (fixed_offset_) {
    at = *fixed_offset_;
  } else {
    CdrWalker walker(payload, *swapped);
    for (const Step& step : steps_) {
      if (step.inside->kind == Kind::kStruct) {
        for (std::uint32_t i = 0; i < step.index; ++i) walker.Skip(*step.inside->members[i].type);
      } else {
        const std::uint32_t count = walker.GetCount(*step.inside);
        if (step.index >= count) {
          throw CdrError("index " + std::to_string(step.index) + " of a list of " +
                         std::to_string(count));
        }
        walker.SkipElements(*step.inside->element, step.index);
      }
    }
    at = leaf_->is_number() ? walker.Align(leaf_->size()) : walker.position();
  }
  if (at > payload.size() || leaf_->size() > payload.size() - at) {
    throw CdrError("the payload of " + std::to_string(payload.size()) +
                   " bytes ends before the field");
  }
  return at;
}

double CdrField::AsDouble(std::span<const std::byte> payload) const {
  bool swapped = false;
  const std::size_t at = Locate(payload, &swapped);
  if (!leaf_->is_number()) throw CdrError("a text is no number");
  return WithNumber(leaf_->kind, [&](auto zero) {
    return static_cast<double>(Load<decltype(zero)>(payload, at, swapped));
  });
}

std::int64_t CdrField::AsInt(std::span<const std::byte> payload) const {
  bool swapped = false;
  const std::size_t at = Locate(payload, &swapped);
  if (!leaf_->is_number()) throw CdrError("a text is no number");
  return WithNumber(leaf_->kind, [&](auto zero) {
    return static_cast<std::int64_t>(Load<decltype(zero)>(payload, at, swapped));
  });
}

std::string CdrField::AsText(std::span<const std::byte> payload) const {
  bool swapped = false;
  const std::size_t at = Locate(payload, &swapped);
  if (leaf_->kind == Kind::kString) {
    CdrWalker walker(payload, swapped);
    walker.Advance(at - kCdrHeaderSize);
    return std::string(walker.GetText(*leaf_));
  }
  if (leaf_->kind != Kind::kEnum) throw CdrError("a number is no text");
  const auto value = Load<std::uint32_t>(payload, at, swapped);
  return value < leaf_->enumerators.size() ? leaf_->enumerators[value] : std::to_string(value);
}

void CdrField::Set(std::span<std::byte> payload, double value) const {
  bool swapped = false;
  const std::size_t at = Locate(payload, &swapped);
  if (!leaf_->is_number()) throw CdrError("a text cannot be set to a number");
  WithNumber(leaf_->kind,
             [&](auto zero) { Store(payload, at, swapped, static_cast<decltype(zero)>(value)); });
}

void CdrField::SetInt(std::span<std::byte> payload, std::int64_t value) const {
  bool swapped = false;
  const std::size_t at = Locate(payload, &swapped);
  if (!leaf_->is_number()) throw CdrError("a text cannot be set to a number");
  WithNumber(leaf_->kind,
             [&](auto zero) { Store(payload, at, swapped, static_cast<decltype(zero)>(value)); });
}

bool HasField(const IdlType& type, std::string_view path) {
  try {
    const CdrField field(type, path);
    return true;
  } catch (const CdrError&) {
    return false;
  }
}

std::vector<std::string> KeyFields(const IdlType& type) {
  std::vector<std::string> keys;
  for (const IdlMember& member : type.members) {
    if (member.key) keys.push_back(member.name);
  }
  return keys;
}

}  // namespace sinew::recording
