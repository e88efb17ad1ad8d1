#include "tools/rerun/message_diff.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace sinew::rerun {
namespace {

// The shortest text that reads back to the same bits.
std::string NumberText(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

class LeafCollector final : public recording::CdrVisitor {
 public:
  explicit LeafCollector(std::vector<Leaf>* leaves) : leaves_(leaves) {}

  void BeginStruct(const recording::IdlType&) override { frames_.push_back({}); }
  void Member(const recording::IdlMember& member) override { frames_.back().member = member.name; }
  void EndStruct() override { End(); }
  void BeginList(std::uint32_t count) override {
    Put(".count", std::to_string(count), count, true);
    frames_.push_back({.list = true});
  }
  void EndList() override { End(); }
  void Bool(bool value) override { Value(value ? "true" : "false", value ? 1.0 : 0.0, true); }
  void Signed(std::int64_t value) override {
    Value(std::to_string(value), static_cast<double>(value), true);
  }
  void Unsigned(std::uint64_t value) override {
    Value(std::to_string(value), static_cast<double>(value), true);
  }
  void Real(double value) override { Value(NumberText(value), value, true); }
  void Enum(std::uint32_t value, const recording::IdlType& type) override {
    Value(value < type.enumerators.size() ? type.enumerators[value] : std::to_string(value), value,
          false);
  }
  void Text(std::string_view value) override { Value("'" + std::string(value) + "'", 0.0, false); }

 private:
  struct Frame {
    bool list = false;
    std::uint32_t index = 0;
    std::string member{};
  };

  void Put(const std::string& suffix, std::string text, double number, bool is_number) {
    std::string path;
    for (const Frame& frame : frames_) {
      if (frame.list) {
        path += "[" + std::to_string(frame.index) + "]";
      } else {
        path += (path.empty() ? "" : ".") + frame.member;
      }
    }
    leaves_->push_back({path + suffix, std::move(text), number, is_number});
  }
  void Value(std::string text, double number, bool is_number) {
    Put("", std::move(text), number, is_number);
    Advance();
  }
  void End() {
    frames_.pop_back();
    Advance();
  }
  void Advance() {
    if (!frames_.empty() && frames_.back().list) ++frames_.back().index;
  }

  std::vector<Leaf>* leaves_;
  std::vector<Frame> frames_;
};

std::string HexByte(std::span<const std::byte> payload, std::size_t at) {
  if (at >= payload.size()) return "nothing: it has " + std::to_string(payload.size()) + " bytes";
  constexpr char kDigits[] = "0123456789abcdef";
  const auto value = static_cast<unsigned>(payload[at]);
  return {'0', 'x', kDigits[value >> 4], kDigits[value & 15u]};
}

}  // namespace

std::vector<Leaf> LeavesOf(const recording::IdlType& type, std::span<const std::byte> payload) {
  std::vector<Leaf> leaves;
  LeafCollector collector(&leaves);
  recording::DecodeCdr(type, payload, &collector);
  return leaves;
}

std::optional<FieldDifference> FirstDifference(const recording::IdlType& type,
                                               std::span<const std::byte> recorded,
                                               std::span<const std::byte> rerun) {
  if (std::equal(recorded.begin(), recorded.end(), rerun.begin(), rerun.end())) return std::nullopt;
  const auto at = std::mismatch(recorded.begin(), recorded.end(), rerun.begin(), rerun.end());
  FieldDifference difference;
  difference.byte = static_cast<std::size_t>(at.first - recorded.begin());
  difference.field = "(payload)";
  difference.recorded = HexByte(recorded, difference.byte);
  difference.rerun = HexByte(rerun, difference.byte);
  try {
    const std::vector<Leaf> before = LeavesOf(type, recorded), after = LeavesOf(type, rerun);
    for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
      // Two texts of one NaN: the bits are not in the text.
      if (before[i].text == after[i].text) continue;
      difference.field = before[i].field;
      difference.recorded = before[i].text;
      difference.rerun = after[i].text;
      break;
    }
  } catch (const recording::CdrError&) {
    // A payload that is no such message: its byte is all there is to say.
  }
  return difference;
}

}  // namespace sinew::rerun
