// The state of an object as bytes, and back to the same bits. A member function lists the fields
// once, for both ways:
//
//   void Pid::Exchange(types::StateArchive& archive) { archive(integral_Nm_, derivative_Nm_); }
//
//   types::StateArchive out;                       // writes
//   pid.Exchange(out);                             // out.bytes()
//   types::StateArchive in(bytes);                 // reads
//   other.Exchange(in);                            // of the same configuration
//   in.Finish();                                   // nothing may be left
//
// Numbers are in the byte order of the machine (little-endian here); vectors carry their sizes,
// which must be those of the object that reads: state fits the configuration that it was written
// with. Reading throws std::invalid_argument; the object is then to be thrown away. Writing
// allocates. Thread: one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sinew::types {

static_assert(std::endian::native == std::endian::little);

class StateArchive {
 public:
  StateArchive() = default;
  explicit StateArchive(std::span<const std::byte> content) : content_(content), reads_(true) {}

  bool reads() const noexcept { return reads_; }
  const std::vector<std::byte>& bytes() const noexcept { return written_; }
  std::vector<std::byte> Release() { return std::move(written_); }

  template <class... T>
  void operator()(T&... fields) {
    (Field(fields), ...);
  }
  // An index or count: read, it must be at most `most`.
  template <class Integer>
  void Bounded(Integer& value, std::type_identity_t<Integer> most) {
    Field(value);
    bool outside = value > most;
    if constexpr (std::is_signed_v<Integer>) outside = outside || value < 0;
    if (reads_ && outside) {
      throw std::invalid_argument("state: an index is " + std::to_string(value) +
                                  ", expected 0 to " + std::to_string(most));
    }
  }
  // After the last field was read. Throws when bytes are left.
  void Finish() const {
    if (at_ != content_.size()) {
      throw std::invalid_argument("state: " + std::to_string(content_.size() - at_) +
                                  " bytes are left, expected none: another configuration");
    }
  }

 private:
  template <class T>
  void Field(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = value ? 1 : 0;
      Raw(&byte, 1);
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      Raw(&value, sizeof(T));
    } else {
      value.Exchange(*this);
    }
  }
  template <class T, std::size_t n>
  void Field(std::array<T, n>& values) {
    for (T& value : values) Field(value);
  }
  template <class T>
  void Field(std::vector<T>& values) {
    CheckSize(values.size());
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      Raw(values.data(), values.size() * sizeof(T));
    } else {
      for (T& value : values) Field(value);
    }
  }
  template <class Scalar, int rows, int columns, int options, int most_rows, int most_columns>
  void Field(Eigen::Matrix<Scalar, rows, columns, options, most_rows, most_columns>& values) {
    CheckSize(static_cast<std::uint64_t>(values.size()));
    Raw(values.data(), static_cast<std::size_t>(values.size()) * sizeof(Scalar));
  }
  // The configuration decides whether an optional value is there: on both sides or on none.
  template <class T>
  void Field(std::optional<T>& value) {
    CheckSize(value ? 1 : 0);
    if (value) Field(*value);
  }

  void CheckSize(std::uint64_t size) {
    std::uint64_t stated = size;
    Raw(&stated, sizeof(stated));
    if (stated != size) {
      throw std::invalid_argument("state: a list of " + std::to_string(stated) + ", expected " +
                                  std::to_string(size) + ": another configuration");
    }
  }
  void Raw(void* data, std::size_t size) {
    if (size == 0) return;
    if (!reads_) {
      const auto* bytes = static_cast<const std::byte*>(data);
      written_.insert(written_.end(), bytes, bytes + size);
      return;
    }
    if (size > content_.size() - at_) {
      throw std::invalid_argument("state: it ends after " + std::to_string(content_.size()) +
                                  " bytes: another configuration");
    }
    std::memcpy(data, content_.data() + at_, size);
    at_ += size;
  }

  std::span<const std::byte> content_;
  std::size_t at_ = 0;
  std::vector<std::byte> written_;
  bool reads_ = false;
};

}  // namespace sinew::types
