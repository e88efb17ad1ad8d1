// Messages to CDR bytes (with the 4-byte encapsulation header) and back. Internal to this module
// and to recordings; needs no DDS to include.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace sinew::node {

using Bytes = std::vector<std::byte>;

// Capacity of `bytes` is reused. A text is cut at its bound. False: a sequence is beyond its bound.
template <class Message>
[[nodiscard]] bool Encode(const Message& message, Bytes* bytes);

// False: the bytes are no such message, or say something that has no meaning: an enumerator without
// a name, a joint_count above 12, a text or sequence beyond its bound. `message` may then hold
// anything.
template <class Message>
[[nodiscard]] bool Decode(const Bytes& bytes, Message* message);

// Session and tick at the head of a message; every type but ComponentStatus begins with its header.
struct HeadOfMessage {
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  std::uint32_t origin = 0;  // as it is on the wire: any number
};
[[nodiscard]] bool PeekHead(const std::byte* bytes, std::size_t size, HeadOfMessage* head);

// Overwrites header.origin in place; for players.
[[nodiscard]] bool PokeOrigin(std::byte* bytes, std::size_t size, std::uint32_t origin);

// Names an event: FNV-1a (64 bits) of its CDR payload with alignment bytes zero, as recorders write
// it (recording/cdr.h, CanonicalizeCdr). Equal messages have equal ids. Allocates.
[[nodiscard]] std::uint64_t EventId(std::span<const std::byte> canonical_payload);
template <class Message>
[[nodiscard]] std::uint64_t EventId(const Message& message) {
  Bytes bytes;  // fresh: what the encoder leaves out is zero
  return Encode(message, &bytes) ? EventId(std::span<const std::byte>(bytes)) : 0;
}

// RTPS key hash (16 bytes) of a keyed message; false when the type has no key.
[[nodiscard]] bool KeyHash(std::string_view type_name, const Bytes& bytes, std::uint8_t hash[16]);

// Largest serialized size of a type, header included.
std::size_t MaxEncodedSize(std::string_view type_name);
bool IsKeyed(std::string_view type_name);

}  // namespace sinew::node
