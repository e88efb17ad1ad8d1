// What a fuzzer without coverage can do to an input: flip, set, insert, remove, repeat, splice.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tests/fuzz/harness.h"

namespace sinew::fuzz {

inline Input Mutate(const std::vector<Input>& seeds, std::size_t most_bytes,
                    std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const auto byte = [&] {
    // Often an end of a field, else any.
    constexpr std::uint8_t kEnds[] = {0x00, 0xFF, 0x7F, 0x80, 0x01, 0x08};
    return random() % 2 == 0 ? kEnds[below(std::size(kEnds))] : static_cast<std::uint8_t>(random());
  };
  Input input = seeds[below(seeds.size())];
  for (std::size_t n = 1 + below(8); n > 0; --n) {
    const std::size_t at = below(input.size() + 1);
    const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
    const auto left = static_cast<std::size_t>(input.end() - place);
    switch (random() % 7) {
      case 0:
        if (left > 0) *place ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1:
        if (left > 0) *place = byte();
        break;
      case 2:
        input.insert(place, byte());
        break;
      case 3:
        input.erase(place, place + static_cast<std::ptrdiff_t>(below(left + 1) % 17));
        break;
      case 4: {
        const Input piece(place, place + static_cast<std::ptrdiff_t>(below(left + 1)));
        input.insert(input.end(), piece.begin(), piece.end());
        break;
      }
      case 5: {
        const Input& other = seeds[below(seeds.size())];
        const auto from = static_cast<std::ptrdiff_t>(below(other.size() + 1));
        input.erase(place, input.end());
        input.insert(input.end(), other.begin() + from, other.end());
        break;
      }
      default:
        for (std::size_t i = below(24); i > 0; --i)
          input.push_back(static_cast<std::uint8_t>(random()));
        break;
    }
  }
  if (input.size() > most_bytes) input.resize(most_bytes);
  return input;
}

}  // namespace sinew::fuzz
