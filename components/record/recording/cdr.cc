#include "components/record/recording/cdr.h"

#include <algorithm>

#include "components/record/recording/cdr_walker.h"

namespace sinew::recording {
namespace {

using Kind = IdlType::Kind;

void Visit(const IdlType& type, CdrWalker* walker, CdrVisitor* visitor) {
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

// Zeroes the bytes up to the position of a number of that size.
void ZeroGap(std::size_t size, CdrWalker* walker, Bytes* payload) {
  const std::size_t from = walker->position();
  const std::size_t to = std::min(walker->Align(size), payload->size());
  for (std::size_t i = from; i < to; ++i) (*payload)[i] = std::byte{0};
}

void ZeroPadding(const IdlType& type, CdrWalker* walker, Bytes* payload) {
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
    out->resize(kCdrHeaderSize + (out->size() - kCdrHeaderSize + size - 1) / size * size);
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

}  // namespace

void DecodeCdr(const IdlType& type, std::span<const std::byte> payload, CdrVisitor* visitor) {
  CdrWalker walker(payload, ReadCdrHeader(payload));
  Visit(type, &walker, visitor);
}

void CanonicalizeCdr(const IdlType& type, Bytes* payload) {
  CdrWalker walker(*payload, ReadCdrHeader(*payload));
  ZeroPadding(type, &walker, payload);
  payload->resize(walker.position());
}

Bytes ZeroCdr(const IdlType& type) {
  Bytes out = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  AppendZero(type, &out);
  return out;
}

}  // namespace sinew::recording
