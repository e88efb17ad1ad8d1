#include "components/recording/cdr.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

namespace sinew::recording {
namespace {

using Kind = IdlType::Kind;

constexpr std::size_t kHeaderSize = 4;

template <class T>
T Swap(T value) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

// Reads the 4-byte header: true when numbers are in the other byte order.
bool ReadHeader(std::span<const std::byte> payload) {
  if (payload.size() < kHeaderSize) throw CdrError("the payload is shorter than its 4-byte header");
  const auto first = static_cast<unsigned>(payload[0]);
  const auto second = static_cast<unsigned>(payload[1]);
  if (first != 0 || second > 1) {
    throw CdrError("encoding " + std::to_string(256 * first + second) +
                   ", expected plain CDR (0: big-endian, 1: little-endian)");
  }
  return second == 0;
}

// Walks a payload; position counts from the start of the payload.
class Walker {
 public:
  Walker(std::span<const std::byte> payload, bool swapped) : payload_(payload), swapped_(swapped) {}

  std::size_t position() const { return position_; }

  // Position of a number of that size.
  std::size_t Align(std::size_t size) {
    if (size > 1) position_ = kHeaderSize + (position_ - kHeaderSize + size - 1) / size * size;
    return position_;
  }
  void Advance(std::uint64_t size) {
    if (position_ > payload_.size() || size > payload_.size() - position_) {
      throw CdrError("the payload of " + std::to_string(payload_.size()) + " bytes ends early");
    }
    position_ += static_cast<std::size_t>(size);
  }
  template <class T>
  T Get() {
    const std::size_t at = Align(sizeof(T));
    Advance(sizeof(T));
    T value;
    std::memcpy(&value, payload_.data() + at, sizeof(T));
    return swapped_ ? Swap(value) : value;
  }
  std::string_view GetText(const IdlType& type) {
    const auto length = Get<std::uint32_t>();  // with the NUL at its end
    const std::size_t start = position_;
    Advance(length);
    if (length == 0) return {};  // some writers leave the NUL of an empty text out
    if (payload_[position_ - 1] != std::byte{0}) throw CdrError("a text does not end with NUL");
    if (type.bound != 0 && length - 1 > type.bound) {
      throw CdrError("a text of " + std::to_string(length - 1) + " bytes, expected at most " +
                     std::to_string(type.bound));
    }
    return {reinterpret_cast<const char*>(payload_.data() + start), length - 1};
  }
  std::uint32_t GetCount(const IdlType& type) {
    if (type.kind == Kind::kArray) return type.bound;
    const auto count = Get<std::uint32_t>();
    if (type.bound != 0 && count > type.bound) {
      throw CdrError("a sequence of " + std::to_string(count) + ", expected at most " +
                     std::to_string(type.bound));
    }
    if (count > payload_.size()) throw CdrError("a sequence is longer than the payload");
    return count;
  }
  void SkipElements(const IdlType& element, std::uint32_t count) {
    if (count == 0) return;
    if (element.is_number()) {
      Align(element.size());
      Advance(std::uint64_t{count} * element.size());
      return;
    }
    for (std::uint32_t i = 0; i < count; ++i) Skip(element);
  }
  void Skip(const IdlType& type) {
    switch (type.kind) {
      case Kind::kStruct:
        for (const IdlMember& member : type.members) Skip(*member.type);
        return;
      case Kind::kArray:
      case Kind::kSequence:
        SkipElements(*type.element, GetCount(type));
        return;
      case Kind::kString:
        GetText(type);
        return;
      default:
        SkipElements(type, 1);
    }
  }

 private:
  std::span<const std::byte> payload_;
  bool swapped_;
  std::size_t position_ = kHeaderSize;
};

void Visit(const IdlType& type, Walker* walker, CdrVisitor* visitor) {
  switch (type.kind) {
    case Kind::kBool:
      return visitor->Bool(walker->Get<std::uint8_t>() != 0);
    case Kind::kOctet:
      return visitor->Unsigned(walker->Get<std::uint8_t>());
    case Kind::kChar:
      return visitor->Signed(walker->Get<std::int8_t>());
    case Kind::kInt16:
      return visitor->Signed(walker->Get<std::int16_t>());
    case Kind::kUint16:
      return visitor->Unsigned(walker->Get<std::uint16_t>());
    case Kind::kInt32:
      return visitor->Signed(walker->Get<std::int32_t>());
    case Kind::kUint32:
      return visitor->Unsigned(walker->Get<std::uint32_t>());
    case Kind::kInt64:
      return visitor->Signed(walker->Get<std::int64_t>());
    case Kind::kUint64:
      return visitor->Unsigned(walker->Get<std::uint64_t>());
    case Kind::kFloat:
      return visitor->Real(static_cast<double>(walker->Get<float>()));
    case Kind::kDouble:
      return visitor->Real(walker->Get<double>());
    case Kind::kEnum:
      return visitor->Enum(walker->Get<std::uint32_t>(), type);
    case Kind::kString:
      return visitor->Text(walker->GetText(type));
    case Kind::kStruct:
      visitor->BeginStruct(type);
      for (const IdlMember& member : type.members) {
        visitor->Member(member);
        Visit(*member.type, walker, visitor);
      }
      return visitor->EndStruct();
    case Kind::kArray:
    case Kind::kSequence: {
      const std::uint32_t count = walker->GetCount(type);
      visitor->BeginList(count);
      for (std::uint32_t i = 0; i < count; ++i) Visit(*type.element, walker, visitor);
      return visitor->EndList();
    }
  }
}

// Size of a type whose size never varies, from a position on; nothing when it varies.
std::optional<std::size_t> FixedEnd(const IdlType& type, std::size_t position) {
  const auto aligned = [&position](std::size_t size) {
    return kHeaderSize + (position - kHeaderSize + size - 1) / size * size;
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

// Zeroes the bytes between `from` and the aligned position.
void ZeroPadding(const IdlType& type, Walker* walker, Bytes* payload);

void ZeroGap(std::size_t size, Walker* walker, Bytes* payload) {
  const std::size_t from = walker->position();
  const std::size_t to = std::min(walker->Align(size), payload->size());
  for (std::size_t i = from; i < to; ++i) (*payload)[i] = std::byte{0};
}

void ZeroPadding(const IdlType& type, Walker* walker, Bytes* payload) {
  if (type.kind == Kind::kStruct) {
    for (const IdlMember& member : type.members) ZeroPadding(*member.type, walker, payload);
    return;
  }
  if (type.is_number()) ZeroGap(type.size(), walker, payload);
  if (type.kind == Kind::kString || type.kind == Kind::kSequence) ZeroGap(4, walker, payload);
  if (type.kind == Kind::kSequence || type.kind == Kind::kArray) {
    const std::uint32_t count = walker->GetCount(type);
    if (count > 0 && type.element->is_number()) {
      ZeroGap(type.element->size(), walker, payload);
      walker->SkipElements(*type.element, count);
      return;
    }
    for (std::uint32_t i = 0; i < count; ++i) ZeroPadding(*type.element, walker, payload);
    return;
  }
  walker->Skip(type);
}

void AppendZero(const IdlType& type, Bytes* out) {
  const auto align = [out](std::size_t size) {
    out->resize(kHeaderSize + (out->size() - kHeaderSize + size - 1) / size * size);
  };
  switch (type.kind) {
    case Kind::kStruct:
      for (const IdlMember& member : type.members) AppendZero(*member.type, out);
      return;
    case Kind::kArray:
      for (std::uint32_t i = 0; i < type.bound; ++i) AppendZero(*type.element, out);
      return;
    case Kind::kSequence:
      align(4);
      Put(out, std::uint32_t{0});
      return;
    case Kind::kString:
      align(4);
      Put(out, std::uint32_t{1});
      Put(out, std::uint8_t{0});
      return;
    default:
      align(type.size());
      out->resize(out->size() + type.size());
  }
}

template <class T>
T Load(std::span<const std::byte> payload, std::size_t at, bool swapped) {
  T value;
  std::memcpy(&value, payload.data() + at, sizeof(T));
  return swapped ? Swap(value) : value;
}

template <class T>
void Store(std::span<std::byte> payload, std::size_t at, bool swapped, T value) {
  if (swapped) value = Swap(value);
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

void DecodeCdr(const IdlType& type, std::span<const std::byte> payload, CdrVisitor* visitor) {
  Walker walker(payload, ReadHeader(payload));
  Visit(type, &walker, visitor);
}

void CanonicalizeCdr(const IdlType& type, Bytes* payload) {
  Walker walker(*payload, ReadHeader(*payload));
  ZeroPadding(type, &walker, payload);
  payload->resize(walker.position());
}

Bytes ZeroCdr(const IdlType& type) {
  Bytes out = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  AppendZero(type, &out);
  return out;
}

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
      std::string list;
      for (const IdlMember& known : leaf_->members) list += (list.empty() ? "" : ", ") + known.name;
      throw CdrError("no field '" + std::string(name) + "' in " + leaf_->name +
                     ", expected one of: " + list);
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

  std::size_t offset = kHeaderSize;
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
  *swapped = ReadHeader(payload);
  std::size_t at = 0;
  if (fixed_offset_) {
    at = *fixed_offset_;
  } else {
    Walker walker(payload, *swapped);
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
    Walker walker(payload, swapped);
    walker.Advance(at - kHeaderSize);
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
