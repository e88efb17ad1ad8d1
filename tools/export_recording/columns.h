// The fields of a topic as columns of a table: one row a message, one column (of one or more
// entries) a number or text.
//
// A list becomes entries of its column. Of a fixed array as many entries count as are in use: a
// struct's octet member whose name ends with `_count` limits the arrays after it in that struct
// (joint_count of every topic of joints, bus_count, output_count). How many entries a column has is
// the most that any message of the recording has; a message with fewer leaves the rest empty. Pure;
// allocates; one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "components/record/recording/cdr.h"

namespace sinew::export_recording {

struct Column {
  std::string path;  // members joined by dots, without indices: "header.tick"
  const recording::IdlType* leaf = nullptr;  // a number, an enum or a text
  std::vector<std::uint32_t> shape;          // entries of the lists around it; empty: one value
  std::uint32_t text_size = 0;               // bytes of the longest text

  std::size_t entries() const;
  // Name of an entry in row-major order: "position_rad[2]".
  std::string EntryName(std::size_t entry) const;
};

// Booleans, characters and enums are whole numbers. A text is valid during the call that gives it.
using Cell = std::variant<std::int64_t, std::uint64_t, double, std::string_view>;

class Columns {
 public:
  // Every list is empty at first. Keeps a reference to the type.
  explicit Columns(const recording::IdlType& type);
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  const std::vector<Column>& list() const { return list_; }
  // Makes place for what the message has. Throws CdrError.
  void Widen(std::span<const std::byte> payload);
  // Calls take(column, entry, value) for everything that is in use in the message; entry is the
  // place in row-major order. The message must have been given to Widen before. Throws CdrError.
  using Take = std::function<void(std::size_t column, std::size_t entry, const Cell& value)>;
  void ForEach(std::span<const std::byte> payload, const Take& take) const;

 private:
  class Walk;
  struct Node {
    const recording::IdlType* type = nullptr;
    std::vector<std::size_t> children;  // nodes of the members, or of the element
    std::size_t column = 0;             // of numbers and texts
    bool counts = false;                // limits the arrays after it
    bool limited = false;               // array whose entries in use are counted
  };
  std::size_t AddNode(const recording::IdlType& type, const std::string& path, std::size_t lists);

  const recording::IdlType& type_;
  std::vector<Node> nodes_;
  std::vector<Column> list_;
};

}  // namespace sinew::export_recording
