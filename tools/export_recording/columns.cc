#include "tools/export_recording/columns.h"

#include <algorithm>
#include <limits>
#include <string_view>

namespace sinew::export_recording {

using recording::IdlType;
using Kind = IdlType::Kind;

std::size_t Column::entries() const {
  std::size_t count = 1;
  for (const std::uint32_t length : shape) count *= length;
  return count;
}

std::string Column::EntryName(std::size_t entry) const {
  std::string indices;
  for (std::size_t level = shape.size(); level-- > 0;) {
    indices = "[" + std::to_string(entry % shape[level]) + "]" + indices;
    entry /= shape[level];
  }
  return path + indices;
}

// Walks a message beside the tree of nodes and gives every value in use with its indices.
class Columns::Walk : public recording::CdrVisitor {
 public:
  using Give = std::function<void(std::size_t column, std::span<const std::uint32_t>, const Cell&)>;
  Walk(const std::vector<Node>& nodes, const Give& give) : nodes_(nodes), give_(give) {}

  void BeginStruct(const IdlType&) override { frames_.push_back({Target()}); }
  void Member(const recording::IdlMember&) override { ++frames_.back().next; }
  void EndStruct() override { frames_.pop_back(); }
  void BeginList(std::uint32_t) override {
    const std::size_t node = Target();
    // The struct around an array says how many of its entries are in use.
    const std::uint32_t used =
        nodes_[node].limited ? frames_.back().limit : std::numeric_limits<std::uint32_t>::max();
    frames_.push_back({node, 0, used});
    indices_.push_back(0);
  }
  void EndList() override {
    frames_.pop_back();
    indices_.pop_back();
  }
  void Bool(bool value) override { Value(std::uint64_t{value ? 1u : 0u}); }
  void Signed(std::int64_t value) override { Value(value); }
  void Unsigned(std::uint64_t value) override {
    const std::size_t node = Value(value);
    if (nodes_[node].counts) frames_.back().limit = static_cast<std::uint32_t>(value);
  }
  void Real(double value) override { Value(value); }
  void Enum(std::uint32_t value, const IdlType&) override { Value(std::uint64_t{value}); }
  void Text(std::string_view value) override { Value(value); }

 private:
  struct Frame {
    std::size_t node;
    std::uint32_t next = 0;  // members or elements begun so far
    std::uint32_t limit = std::numeric_limits<std::uint32_t>::max();  // entries in use
  };

  // The node of the value that comes now.
  std::size_t Target() {
    if (frames_.empty()) return 0;
    Frame& frame = frames_.back();
    const Node& node = nodes_[frame.node];
    if (node.type->kind == Kind::kStruct) return node.children[frame.next - 1];
    indices_.back() = frame.next++;
    return node.children.front();
  }

  std::size_t Value(const Cell& value) {
    const std::size_t node = Target();
    const bool used = std::all_of(frames_.begin(), frames_.end(), [this](const Frame& frame) {
      return nodes_[frame.node].type->kind == Kind::kStruct || frame.next <= frame.limit;
    });
    if (used) give_(nodes_[node].column, indices_, value);
    return node;
  }

  const std::vector<Node>& nodes_;
  const Give& give_;
  std::vector<Frame> frames_;
  std::vector<std::uint32_t> indices_;
};

Columns::Columns(const IdlType& type) : type_(type) { AddNode(type, "", 0); }

std::size_t Columns::AddNode(const IdlType& type, const std::string& path, std::size_t lists) {
  const std::size_t index = nodes_.size();
  nodes_.push_back({&type, {}, 0, false, false});
  switch (type.kind) {
    case Kind::kStruct: {
      bool counted = false;
      for (const recording::IdlMember& member : type.members) {
        const std::string inner = path.empty() ? member.name : path + "." + member.name;
        const std::size_t child = AddNode(*member.type, inner, lists);
        nodes_[index].children.push_back(child);
        nodes_[child].limited = counted && member.type->kind == Kind::kArray;
        nodes_[child].counts = member.type->kind == Kind::kOctet && member.name.ends_with("_count");
        counted = counted || nodes_[child].counts;
      }
      break;
    }
    case Kind::kArray:
    case Kind::kSequence: {
      const std::size_t child = AddNode(*type.element, path, lists + 1);
      nodes_[index].children.push_back(child);
      break;
    }
    default:
      nodes_[index].column = list_.size();
      list_.push_back({path, &type, std::vector<std::uint32_t>(lists, 0), 0});
  }
  return index;
}

void Columns::Widen(std::span<const std::byte> payload) {
  const Walk::Give give = [this](std::size_t column, std::span<const std::uint32_t> indices,
                                 const Cell& value) {
    Column& widened = list_[column];
    for (std::size_t level = 0; level < indices.size(); ++level) {
      widened.shape[level] = std::max(widened.shape[level], indices[level] + 1);
    }
    if (const auto* text = std::get_if<std::string_view>(&value)) {
      widened.text_size = std::max(widened.text_size, static_cast<std::uint32_t>(text->size()));
    }
  };
  Walk walk(nodes_, give);
  recording::DecodeCdr(type_, payload, &walk);
}

void Columns::ForEach(std::span<const std::byte> payload, const Take& take) const {
  const Walk::Give give = [this, &take](std::size_t column, std::span<const std::uint32_t> indices,
                                        const Cell& value) {
    std::size_t entry = 0;
    for (std::size_t level = 0; level < indices.size(); ++level) {
      entry = entry * list_[column].shape[level] + indices[level];
    }
    take(column, entry, value);
  };
  Walk walk(nodes_, give);
  recording::DecodeCdr(type_, payload, &walk);
}

}  // namespace sinew::export_recording
