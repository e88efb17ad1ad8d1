// What is done to a well-formed payload: bits, bytes, length, doubles, counts and enumerators,
// session and tick.
//
// A payload is CDR with a header of 4 bytes; alignment counts from its end. Deterministic by seed.
// Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "components/topics/node/codec.h"

namespace sinew::payloads {

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  // One to four changes. No longer than most_bytes, which is what DDS would deliver of the type.
  void Mutate(std::size_t most_bytes, node::Bytes* payload);

  std::uint64_t Random() { return random_(); }
  std::size_t Below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random_() % n); }
  bool OneIn(std::size_t n) { return Below(n) == 0; }

 private:
  void MutateOnce(node::Bytes* payload);
  void ChangeHeader(node::Bytes* payload);
  // Little-endian, at a multiple of the value's size from the end of the encapsulation.
  template <class Value>
  void SetAligned(Value value, node::Bytes* payload);

  std::mt19937_64 random_;
};

// Overwrites session, tick and the stamp that belongs to it of a little-endian payload that begins
// with its header.
void SetHead(std::uint64_t session_id, std::uint64_t tick, node::Bytes* payload);

}  // namespace sinew::payloads
