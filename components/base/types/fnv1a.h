// FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923): names bytes that nobody chose to collide.
//
// Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace sinew::types {

class Fnv1a {
 public:
  void Add(std::byte byte) noexcept {
    hash_ = (hash_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001B3u;
  }
  void Add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) Add(byte);
  }

  std::uint64_t value() const noexcept { return hash_; }
  // 16 hex digits.
  std::string Text() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash_));
    return text;
  }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325u;
};

}  // namespace sinew::types
