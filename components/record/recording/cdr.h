// CDR as DDS sends it (XCDR version 1, plain; RTPS 2.5, 10.2): a 4-byte header, then the members in
// order, each number aligned to its size from the first byte after the header.
//
// Everything works on bytes and an IdlType; no generated code is needed. Decoding never reads
// outside the payload: what does not fit throws CdrError. Field access after construction allocates
// nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "components/record/recording/bytes.h"
#include "components/record/recording/idl_schema.h"

namespace sinew::recording {

// The payload does not fit its type.
class CdrError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Receives every value of a message in order.
class CdrVisitor {
 public:
  virtual ~CdrVisitor() = default;
  virtual void BeginStruct(const IdlType& type) = 0;
  virtual void Member(const IdlMember& member) = 0;  // its value follows
  virtual void EndStruct() = 0;
  virtual void BeginList(std::uint32_t count) = 0;  // array or sequence
  virtual void EndList() = 0;
  virtual void Bool(bool value) = 0;
  virtual void Signed(std::int64_t value) = 0;
  virtual void Unsigned(std::uint64_t value) = 0;
  virtual void Real(double value) = 0;
  virtual void Enum(std::uint32_t value, const IdlType& type) = 0;
  virtual void Text(std::string_view value) = 0;
};

// Throws CdrError.
void DecodeCdr(const IdlType& type, std::span<const std::byte> payload, CdrVisitor* visitor);

// Zeroes alignment bytes (senders leave what was in memory there) and cuts bytes after the last
// member, so that equal messages are equal bytes. Throws CdrError, payload then unchanged in size.
void CanonicalizeCdr(const IdlType& type, Bytes* payload);

// A little-endian message with every number 0, every text and sequence empty.
Bytes ZeroCdr(const IdlType& type);

// One number (or text) of a message by its path: "header.tick", "position_rad[0]".
class CdrField {
 public:
  // Throws CdrError when the type has no such field, or the path ends at no number or text.
  CdrField(const IdlType& type, std::string_view path);

  const IdlType& type() const { return *leaf_; }
  // Throw CdrError when the payload is too short for it.
  double AsDouble(std::span<const std::byte> payload) const;
  std::int64_t AsInt(std::span<const std::byte> payload) const;
  std::string AsText(std::span<const std::byte> payload) const;  // texts, and labels of enums
  // In place; numbers only.
  void Set(std::span<std::byte> payload, double value) const;
  void SetInt(std::span<std::byte> payload, std::int64_t value) const;

 private:
  struct Step {
    const IdlType* inside;  // struct, array or sequence
    std::uint32_t index;    // of the member or element
  };
  std::size_t Locate(std::span<const std::byte> payload, bool* swapped) const;

  std::vector<Step> steps_;
  const IdlType* leaf_ = nullptr;
  std::optional<std::size_t>
      fixed_offset_;  // from the start of the payload, when nothing before it varies
};

// True when the type has the field.
bool HasField(const IdlType& type, std::string_view path);

// Paths of the members marked @key: what identifies an instance.
std::vector<std::string> KeyFields(const IdlType& type);

}  // namespace sinew::recording
