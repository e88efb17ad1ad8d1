#include "components/record/recording/file/cdr_json.h"

#include <cmath>

namespace sinew::recording {
namespace {

using Json = nlohmann::ordered_json;

class JsonVisitor : public CdrVisitor {
 public:
  Json Take() { return std::move(root_); }

  void BeginStruct(const IdlType&) override { Open(Json::object()); }
  void Member(const IdlMember& member) override { key_ = member.name; }
  void EndStruct() override { stack_.pop_back(); }
  void BeginList(std::uint32_t) override { Open(Json::array()); }
  void EndList() override { stack_.pop_back(); }
  void Bool(bool value) override { Add(value); }
  void Signed(std::int64_t value) override { Add(value); }
  void Unsigned(std::uint64_t value) override { Add(value); }
  void Real(double value) override {
    if (std::isfinite(value)) return Add(value), void();
    Add(std::isnan(value) ? "NaN" : value > 0 ? "Infinity" : "-Infinity");
  }
  void Enum(std::uint32_t value, const IdlType& type) override {
    if (value < type.enumerators.size()) return Add(type.enumerators[value]), void();
    Add(value);
  }
  void Text(std::string_view value) override { Add(std::string(value)); }

 private:
  Json& Add(Json value) {
    if (stack_.empty()) return root_ = std::move(value);
    Json& parent = *stack_.back();
    if (parent.is_array()) return parent.emplace_back(std::move(value));
    return parent[key_] = std::move(value);
  }
  void Open(Json value) { stack_.push_back(&Add(std::move(value))); }

  Json root_;
  std::vector<Json*> stack_;
  std::string key_;
};

}  // namespace

nlohmann::ordered_json CdrToJson(const IdlType& type, std::span<const std::byte> payload) {
  JsonVisitor visitor;
  DecodeCdr(type, payload, &visitor);
  return visitor.Take();
}

}  // namespace sinew::recording
