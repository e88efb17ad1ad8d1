#include "bench/payloads/mutator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace sinew::payloads {
namespace {

constexpr std::size_t kEncapsulation = 4;
constexpr std::size_t kSessionAt = kEncapsulation;
constexpr std::size_t kTickAt = kSessionAt + 8;
constexpr std::size_t kStampAt = kTickAt + 8;
constexpr std::size_t kOriginAt = kStampAt + 8;

using Limits = std::numeric_limits<double>;
constexpr std::array kDoubles = {Limits::quiet_NaN(),
                                 -Limits::quiet_NaN(),
                                 Limits::signaling_NaN(),
                                 Limits::infinity(),
                                 -Limits::infinity(),
                                 Limits::denorm_min(),
                                 -Limits::denorm_min(),
                                 Limits::min(),
                                 Limits::max(),
                                 Limits::lowest(),
                                 1e-300,
                                 1e300,
                                 -1e154,
                                 1e19,
                                 -9.3e18,
                                 4.3e9,
                                 1e9,
                                 1e3,
                                 -1.0,
                                 -0.0,
                                 0.0};

// Enumerators, joint counts, lengths of texts and sequences.
constexpr std::array<std::uint32_t, 16> kWords = {
    0, 1, 2, 3, 4, 5, 7, 8, 12, 13, 640, 641, 7680, 7681, 0x7FFFFFFFu, 0xFFFFFFFFu};
constexpr std::array<std::uint8_t, 10> kCounts = {0, 1, 2, 11, 12, 13, 127, 128, 254, 255};

constexpr std::array<std::uint64_t, 8> kJumps = {1,    2,          5,          100,
                                                 1024, 1ull << 32, 1ull << 62, 1ull << 63};

template <class Value>
void Store(Value value, std::size_t at, node::Bytes* payload) {
  if (at + sizeof(value) > payload->size()) return;
  std::memcpy(payload->data() + at, &value, sizeof(value));
}

std::uint64_t Load(std::size_t at, const node::Bytes& payload) {
  std::uint64_t value = 0;
  if (at + sizeof(value) <= payload.size()) std::memcpy(&value, payload.data() + at, sizeof(value));
  return value;
}

}  // namespace

void SetHead(std::uint64_t session_id, std::uint64_t tick, node::Bytes* payload) {
  constexpr std::uint64_t kPeriod_ns = 4'166'667;  // of 240 Hz
  Store(session_id, kSessionAt, payload);
  Store(tick, kTickAt, payload);
  Store(tick * kPeriod_ns, kStampAt, payload);
}

template <class Value>
void Mutator::SetAligned(Value value, node::Bytes* payload) {
  if (payload->size() < kEncapsulation + sizeof(value)) return;
  const std::size_t places = (payload->size() - kEncapsulation) / sizeof(value);
  Store(value, kEncapsulation + sizeof(value) * Below(places), payload);
}

void Mutator::ChangeHeader(node::Bytes* payload) {
  switch (Below(6)) {
    case 0:
      return Store(random_(), kSessionAt, payload);
    case 1:
      return Store(Load(kTickAt, *payload) + kJumps[Below(kJumps.size())], kTickAt, payload);
    case 2:
      return Store(Load(kTickAt, *payload) - kJumps[Below(kJumps.size())], kTickAt, payload);
    case 3:
      return Store(OneIn(2) ? 0 : ~std::uint64_t{0}, kTickAt, payload);
    case 4:
      return Store(OneIn(2) ? random_() : kJumps[Below(kJumps.size())], kStampAt, payload);
    default:
      return Store(static_cast<std::uint32_t>(Below(4)), kOriginAt, payload);
  }
}

void Mutator::MutateOnce(node::Bytes* payload) {
  const std::size_t at = Below(payload->size());
  switch (Below(16)) {
    case 0:
      if (!payload->empty()) (*payload)[at] ^= static_cast<std::byte>(1u << Below(8));
      return;
    case 1:
      if (!payload->empty()) (*payload)[at] = static_cast<std::byte>(random_());
      return;
    case 2:
      if (OneIn(2)) return payload->resize(at);
      return payload->resize(payload->size() - std::min<std::size_t>(payload->size(), Below(9)));
    case 3:
      for (std::size_t n = Below(65); n > 0; --n) {
        payload->push_back(static_cast<std::byte>(random_()));
      }
      return;
    case 4:
      return ChangeHeader(payload);
    case 5:
      if (payload->size() >= kEncapsulation) {
        (*payload)[Below(kEncapsulation)] = static_cast<std::byte>(Below(8));
      }
      return;
    case 6:
      return SetAligned(kCounts[Below(kCounts.size())], payload);
    case 7:
    case 8:
      return SetAligned(kWords[Below(kWords.size())], payload);
    case 9: {  // a whole array
      const double value = kDoubles[Below(kDoubles.size())];
      std::size_t place = kEncapsulation + 8 * Below(payload->size() / 8);
      for (std::size_t n = Below(25); n > 0; --n, place += 8) Store(value, place, payload);
      return;
    }
    case 10:
      return SetAligned(random_(), payload);
    default:
      return SetAligned(kDoubles[Below(kDoubles.size())], payload);
  }
}

void Mutator::Mutate(std::size_t most_bytes, node::Bytes* payload) {
  std::size_t changes = 1;
  while (changes < 4 && OneIn(3)) ++changes;
  for (; changes > 0; --changes) MutateOnce(payload);
  if (payload->size() > most_bytes) payload->resize(most_bytes);
}

}  // namespace sinew::payloads
