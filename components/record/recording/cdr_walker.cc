#include "components/record/recording/cdr_walker.h"

namespace sinew::recording {

namespace {

using Kind = IdlType::Kind;

}  // namespace

bool ReadCdrHeader(std::span<const std::byte> payload) {
  if (payload.size() < kCdrHeaderSize)
    throw CdrError("the payload is shorter than its 4-byte header");
  const auto first = static_cast<unsigned>(payload[0]);
  const auto second = static_cast<unsigned>(payload[1]);
  if (first != 0 || second > 1) {
    throw CdrError("encoding " + std::to_string(256 * first + second) +
                   ", expected plain CDR (0: big-endian, 1: little-endian)");
  }
  return second == 0;
}

std::string_view CdrWalker::GetText(const IdlType& type) {
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

std::uint32_t CdrWalker::GetCount(const IdlType& type) {
  if (type.kind == Kind::kArray) return type.bound;
  const auto count = Get<std::uint32_t>();
  if (type.bound != 0 && count > type.bound) {
    throw CdrError("a sequence of " + std::to_string(count) + ", expected at most " +
                   std::to_string(type.bound));
  }
  if (count > payload_.size()) throw CdrError("a sequence is longer than the payload");
  return count;
}

void CdrWalker::SkipElements(const IdlType& element, std::uint32_t count) {
  if (count == 0) return;
  if (element.is_number()) {
    Align(element.size());
    Advance(std::uint64_t{count} * element.size());
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) Skip(element);
}

void CdrWalker::Skip(const IdlType& type) {
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

}  // namespace sinew::recording
