#include "components/base/config/yaml_text.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "components/base/config/config.h"

namespace sinew::config {

namespace {

// Refuses what yaml-cpp would load without a word: bounds, keys given twice, keys without a value.
// Runs before a node is made.
class DocumentCheck : public YAML::EventHandler {
 public:
  explicit DocumentCheck(std::string name) : name_(std::move(name)) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) Fail(mark, "a second document begins here, expected one in a file");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (!open_.empty() && open_.back().at_value) {
      Fail(mark, "key '" + Path() + "': empty, expected a value");
    }
    AddScalar(mark, "", anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = sizes_.find(anchor);
    if (found == sizes_.end()) {  // its end was not seen yet
      Fail(mark, "a value contains itself by an alias, expected aliases of values that ended");
    }
    Add(mark, found->second.nodes);
    Reach(mark, open_.size() + found->second.levels);
    Next(mark, std::nullopt);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string& value) override {
    AddScalar(mark, value, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Begin(mark, anchor, false);
  }
  void OnSequenceEnd() override { End(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Begin(mark, anchor, true);
  }
  void OnMapEnd() override { End(); }

 private:
  struct Size {
    std::size_t nodes = 1;
    std::size_t levels = 0;  // of sequences and maps
  };
  struct Open {
    YAML::anchor_t anchor;
    std::size_t before;  // nodes when it began
    bool is_map;
    std::size_t deepest = 0;  // level in it
    std::size_t entries = 0;
    bool at_value = false;  // of a map: the value of `key` is the next
    std::string key{};
    std::set<std::string> keys{};
  };

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& what) const {
    throw UsageError(name_ + ":" + std::to_string(mark.line + 1) + ": " + what);
  }
  // As Section names a key: "joints[0].limits.upper_rad".
  std::string Path() const {
    std::string path;
    for (const Open& open : open_) {
      if (open.is_map) {
        path += (path.empty() ? "" : ".") + open.key;
      } else if (&open != &open_.back()) {
        path += "[" + std::to_string(open.entries) + "]";
      }
    }
    return path;
  }
  // A value has ended, or a key of the innermost map, with its text where it is a word.
  void Next(const YAML::Mark& mark, const std::optional<std::string>& text) {
    if (open_.empty()) return;
    Open& open = open_.back();
    if (open.is_map && !open.at_value) {
      open.key = text.value_or("");
      if (text && !open.keys.insert(*text).second) Fail(mark, "key '" + Path() + "': given twice");
    } else {
      ++open.entries;
    }
    open.at_value = open.is_map && !open.at_value;
  }
  void Add(const YAML::Mark& mark, std::size_t nodes) {
    nodes_ += nodes;  // both are at most kMostYamlNodes
    if (nodes_ > kMostYamlNodes) {
      Fail(mark, "more than " + std::to_string(kMostYamlNodes) +
                     " values with those of aliases, expected fewer");
    }
  }
  void AddScalar(const YAML::Mark& mark, const std::string& text, YAML::anchor_t anchor) {
    Add(mark, 1);
    if (anchor != YAML::NullAnchor) sizes_[anchor] = {};
    Next(mark, text);
  }
  void Reach(const YAML::Mark& mark, std::size_t level) {
    if (level > kMostYamlLevels) {
      Fail(mark, "more than " + std::to_string(kMostYamlLevels) +
                     " levels with those of aliases, expected fewer");
    }
    if (!open_.empty()) open_.back().deepest = std::max(open_.back().deepest, level);
  }
  void Begin(const YAML::Mark& mark, YAML::anchor_t anchor, bool is_map) {
    open_.push_back({anchor, nodes_, is_map});
    Add(mark, 1);
    Reach(mark, open_.size());
  }
  void End() {
    const Open ended = open_.back();
    open_.pop_back();
    if (!open_.empty()) open_.back().deepest = std::max(open_.back().deepest, ended.deepest);
    Next({}, std::nullopt);
    if (ended.anchor == YAML::NullAnchor) return;
    sizes_[ended.anchor] = {nodes_ - ended.before, ended.deepest - open_.size()};
  }

  std::string name_;
  int documents_ = 0;
  std::size_t nodes_ = 0;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Size> sizes_;
};

}  // namespace

YAML::Node ParseYaml(const std::string& text, const std::string& name) {
  try {
    std::istringstream in(text);
    DocumentCheck check(name);
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(check)) {
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw UsageError(name + line + ": no valid YAML: " + error.msg);
  }
}

}  // namespace sinew::config
