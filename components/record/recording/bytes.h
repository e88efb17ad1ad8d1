// Little-endian numbers and length-prefixed texts, in and out of byte vectors.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::recording {

using Bytes = std::vector<std::byte>;

static_assert(std::endian::native == std::endian::little, "written for little-endian machines");

template <std::integral T>
void Put(Bytes* out, T value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  out->insert(out->end(), first, first + sizeof(T));
}

template <std::integral T>
void PutAt(Bytes* out, std::size_t offset, T value) {
  std::memcpy(out->data() + offset, &value, sizeof(T));
}

inline void PutRaw(Bytes* out, std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  out->insert(out->end(), first, first + text.size());
}

inline void PutText(Bytes* out, std::string_view text) {
  Put(out, static_cast<std::uint32_t>(text.size()));
  PutRaw(out, text);
}

// Reads on from a position; after the first read past the end everything is 0 and ok() is false.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T Get() {
    T value{};
    const auto part = Take(sizeof(T));
    if (part.size() == sizeof(T)) std::memcpy(&value, part.data(), sizeof(T));
    return value;
  }
  std::string GetText() { return AsText(Take(Get<std::uint32_t>())); }
  std::span<const std::byte> Take(std::uint64_t size) {
    if (size > bytes_.size() - position_) {
      ok_ = false;
      position_ = bytes_.size();
      return {};
    }
    const auto part = bytes_.subspan(position_, static_cast<std::size_t>(size));
    position_ += static_cast<std::size_t>(size);
    return part;
  }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }
  bool ok() const { return ok_; }

  static std::string AsText(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace sinew::recording
