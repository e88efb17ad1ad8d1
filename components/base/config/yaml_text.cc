#include "components/base/config/yaml_text.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "components/base/config/config.h"

namespace sinew::config {

namespace {

// Counts what a reader of the document would visit, before a node is made.
class NodeCounter : public YAML::EventHandler {
 public:
  explicit NodeCounter(std::string name) : name_(std::move(name)) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { AddScalar(mark, anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = sizes_.find(anchor);
    if (found == sizes_.end()) {  // its end was not seen yet
      Fail(mark, "a value contains itself by an alias, expected aliases of values that ended");
    }
    Add(mark, found->second.nodes);
    Reach(mark, open_.size() + found->second.levels);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    AddScalar(mark, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Begin(mark, anchor);
  }
  void OnSequenceEnd() override { End(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Begin(mark, anchor);
  }
  void OnMapEnd() override { End(); }

 private:
  struct Size {
    std::size_t nodes = 1;
    std::size_t levels = 0;  // of sequences and maps
  };
  struct Open {
    YAML::anchor_t anchor;
    std::size_t before;   // nodes when it began
    std::size_t deepest;  // level in it
  };

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& what) const {
    throw UsageError(name_ + ":" + std::to_string(mark.line + 1) + ": " + what);
  }
  void Add(const YAML::Mark& mark, std::size_t nodes) {
    nodes_ += nodes;  // both are at most kMostYamlNodes
    if (nodes_ > kMostYamlNodes) {
      Fail(mark, "more than " + std::to_string(kMostYamlNodes) +
                     " values with those of aliases, expected fewer");
    }
  }
  void AddScalar(const YAML::Mark& mark, YAML::anchor_t anchor) {
    Add(mark, 1);
    if (anchor != YAML::NullAnchor) sizes_[anchor] = {};
  }
  void Reach(const YAML::Mark& mark, std::size_t level) {
    if (level > kMostYamlLevels) {
      Fail(mark, "more than " + std::to_string(kMostYamlLevels) +
                     " levels with those of aliases, expected fewer");
    }
    if (!open_.empty()) open_.back().deepest = std::max(open_.back().deepest, level);
  }
  void Begin(const YAML::Mark& mark, YAML::anchor_t anchor) {
    open_.push_back({anchor, nodes_, 0});
    Add(mark, 1);
    Reach(mark, open_.size());
  }
  void End() {
    const Open ended = open_.back();
    open_.pop_back();
    if (!open_.empty()) open_.back().deepest = std::max(open_.back().deepest, ended.deepest);
    if (ended.anchor == YAML::NullAnchor) return;
    sizes_[ended.anchor] = {nodes_ - ended.before, ended.deepest - open_.size()};
  }

  std::string name_;
  std::size_t nodes_ = 0;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Size> sizes_;
};

}  // namespace

YAML::Node ParseYaml(const std::string& text, const std::string& name) {
  try {
    std::istringstream in(text);
    NodeCounter counter(name);
    YAML::Parser(in).HandleNextDocument(counter);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw UsageError(name + line + ": no valid YAML: " + error.msg);
  }
}

}  // namespace sinew::config
