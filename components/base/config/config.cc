#include "components/base/config/config.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>

#include "components/base/config/whole_file.h"
#include "components/base/config/yaml_text.h"
#include "components/base/types/joined.h"
#include "components/base/types/seconds.h"
#include "components/base/types/unit_name.h"

namespace sinew::config {

namespace {

std::string Where(const std::filesystem::path& file, int line) {
  return line > 0 ? file.string() + ":" + std::to_string(line) : file.string();
}

int LineOf(const YAML::Node& node) { return node.IsDefined() ? node.Mark().line + 1 : 0; }

std::string FormatNumber(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string RangeText(Range range) {
  const bool has_lower = std::isfinite(range.lower), has_upper = std::isfinite(range.upper);
  if (range.lower == kPositive.lower && !has_upper) return "a number above 0";
  if (has_lower && has_upper) {
    return "a number from " + FormatNumber(range.lower) + " to " + FormatNumber(range.upper);
  }
  if (has_lower) return "a number of at least " + FormatNumber(range.lower);
  if (has_upper) return "a number of at most " + FormatNumber(range.upper);
  return "a finite number";
}

std::optional<double> ToNumber(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const char* begin = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end || begin == end) return std::nullopt;
  return value;
}

// Magnitudes of a value that is converted to whole nanoseconds somewhere: of a time, up to a
// century; of a frequency, whose period is from a nanosecond to a century. Others have no limit.
Range TimesOf(std::string_view key) {
  if (key.ends_with("_Hz")) return {1.0 / types::kLongest_s, 1e9};
  for (const auto& [unit, per_s] : {std::pair{"_s", 1.0}, std::pair{"_ms", 1e3},
                                    std::pair{"_us", 1e6}, std::pair{"_ns", 1e9}}) {
    if (key.ends_with(unit)) return {0.0, types::kLongest_s * per_s};
  }
  return {0.0, std::numeric_limits<double>::infinity()};
}

// "viscous_Nm_s_rad" and "viscous_Nm" share the stem "viscous": names that differ only by their
// unit.
std::string Stem(const std::string& key) { return types::SplitUnit(key).stem; }

}  // namespace

struct Section::Impl {
  std::filesystem::path file;
  std::string prefix;  // "" or "a.b."
  YAML::Node node;     // map, or undefined for an empty section
  int line = 0;
  mutable std::set<std::string> asked;
  mutable std::vector<std::shared_ptr<Impl>> children;

  std::string Name(std::string_view key) const { return prefix + std::string(key); }

  YAML::Node Get(std::string_view key) const {
    asked.insert(std::string(key));
    if (!node.IsDefined() || !node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    const YAML::Node& constant = node;
    return constant[std::string(key)];
  }

  [[noreturn]] void Fail(std::string_view key, int at, const std::string& message) const {
    throw UsageError(Where(file, at > 0 ? at : line) + ": key '" + Name(key) + "': " + message);
  }

  YAML::Node Need(std::string_view key, const std::string& expected) const {
    YAML::Node value = Get(key);
    if (!value.IsDefined()) {
      const std::string stem = Stem(std::string(key));
      if (node.IsDefined() && node.IsMap()) {
        for (const auto& entry : node) {
          const std::string other = entry.first.Scalar();
          if (other != key && other.find('_') != std::string::npos && Stem(other) == stem) {
            Fail(other, LineOf(entry.first), "wrong unit, expected '" + Name(key) + "'");
          }
        }
      }
      Fail(key, 0, "missing, expected " + expected);
    }
    return value;
  }

  double ParseNumber(std::string_view key, const YAML::Node& value, Range range) const {
    if (!value.IsScalar()) Fail(key, LineOf(value), "expected " + RangeText(range));
    const auto number = ToNumber(value.Scalar());
    if (!number || !std::isfinite(*number) || *number < range.lower || *number > range.upper) {
      Fail(key, LineOf(value), "'" + value.Scalar() + "', expected " + RangeText(range));
    }
    const Range times = TimesOf(key);
    if (*number != 0.0 && (std::abs(*number) < times.lower || std::abs(*number) > times.upper)) {
      Fail(key, LineOf(value),
           "'" + value.Scalar() + "', expected 0, or " + FormatNumber(times.lower) + " to " +
               FormatNumber(times.upper) + " (a century)");
    }
    return *number;
  }
};

Section::Section(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

Section Section::Parse(const std::string& text, const std::string& name, std::string_view schema) {
  auto impl = std::make_shared<Impl>();
  impl->file = name;
  impl->node = ParseYaml(text, name);
  impl->line = 1;
  if (!impl->node.IsMap()) {
    throw UsageError(Where(impl->file, 1) +
                     ": expected a mapping with 'schema: " + std::string(schema) + "'");
  }
  Section section(impl);
  const std::string found = section.Text("schema");
  if (found != schema) {
    impl->Fail("schema", LineOf(impl->node["schema"]),
               "'" + found + "', expected '" + std::string(schema) + "'");
  }
  return section;
}

Section Section::Load(const std::filesystem::path& path, std::string_view schema) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema " + std::string(schema));
  }
  return Parse(ReadFile(path), path.string(), schema);
}

Section Section::Empty(const std::string& name) {
  auto impl = std::make_shared<Impl>();
  impl->file = name;
  impl->node = YAML::Node(YAML::NodeType::Undefined);
  return Section(impl);
}

bool Section::Has(std::string_view key) const {
  const YAML::Node value = impl_->Get(key);
  return value.IsDefined() && !value.IsNull();
}

double Section::Number(std::string_view key, Range range) const {
  return impl_->ParseNumber(key, impl_->Need(key, RangeText(range)), range);
}

std::int64_t Section::Integer(std::string_view key, Range range) const {
  return ToInteger(key, Number(key, range));
}

std::int64_t Section::ToInteger(std::string_view key, double number) const {
  if (number != std::floor(number) || std::abs(number) > 9.0e15) {
    Fail(key, "'" + FormatNumber(number) + "', expected a whole number");
  }
  return static_cast<std::int64_t>(number);
}

bool Section::BoolOr(std::string_view key, bool fallback) const {
  if (!Has(key)) return fallback;
  const YAML::Node value = impl_->Get(key);
  if (value.IsScalar() && value.Scalar() == "true") return true;
  if (value.IsScalar() && value.Scalar() == "false") return false;
  Fail(key, "expected true or false");
}

std::string Section::Text(std::string_view key) const {
  const YAML::Node value = impl_->Need(key, "text");
  if (!value.IsScalar()) Fail(key, "expected text");
  return value.Scalar();
}

std::string Section::Choice(std::string_view key, const std::vector<std::string>& allowed) const {
  impl_->Need(key, "one of " + types::Joined(allowed));
  std::string word = Text(key);
  if (std::find(allowed.begin(), allowed.end(), word) == allowed.end()) {
    Fail(key, "'" + word + "', expected one of " + types::Joined(allowed));
  }
  return word;
}

std::vector<double> Section::Numbers(std::string_view key, Range range) const {
  const YAML::Node value = impl_->Need(key, "a list of numbers");
  if (!value.IsSequence()) Fail(key, "expected a list of numbers");
  std::vector<double> numbers;
  for (const YAML::Node& entry : value) numbers.push_back(impl_->ParseNumber(key, entry, range));
  return numbers;
}

std::vector<std::int64_t> Section::Integers(std::string_view key, Range range) const {
  std::vector<std::int64_t> integers;
  for (const double number : Numbers(key, range)) integers.push_back(ToInteger(key, number));
  return integers;
}

std::vector<std::string> Section::TextsOr(std::string_view key,
                                          std::vector<std::string> fallback) const {
  if (!Has(key)) return fallback;
  const YAML::Node value = impl_->Get(key);
  if (!value.IsSequence()) Fail(key, "expected a list of texts");
  std::vector<std::string> texts;
  for (const YAML::Node& entry : value) {
    if (!entry.IsScalar()) Fail(key, "expected a list of texts");
    texts.push_back(entry.Scalar());
  }
  return texts;
}

std::filesystem::path Section::ExistingPath(std::string_view key) const {
  std::filesystem::path path = Text(key);
  if (path.is_relative()) path = impl_->file.parent_path() / path;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) Fail(key, "no such file: " + path.string());
  return path;
}

Section Section::Child(std::string_view key) const {
  const YAML::Node value = impl_->Need(key, "a mapping");
  if (!value.IsMap()) Fail(key, "expected a mapping");
  auto child = std::make_shared<Impl>();
  child->file = impl_->file;
  child->prefix = impl_->Name(key) + ".";
  child->node = value;
  child->line = LineOf(value);
  impl_->children.push_back(child);
  return Section(child);
}

Section Section::ChildOrEmpty(std::string_view key) const {
  if (Has(key)) return Child(key);
  auto child = std::make_shared<Impl>();
  child->file = impl_->file;
  child->prefix = impl_->Name(key) + ".";
  child->node = YAML::Node(YAML::NodeType::Undefined);
  child->line = impl_->line;
  return Section(child);
}

std::vector<Section> Section::List(std::string_view key) const {
  const YAML::Node value = impl_->Need(key, "a list of mappings");
  if (!value.IsSequence()) Fail(key, "expected a list of mappings");
  std::vector<Section> sections;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!value[i].IsMap()) {
      impl_->Fail(std::string(key) + "[" + std::to_string(i) + "]", LineOf(value[i]),
                  "expected a mapping");
    }
    auto child = std::make_shared<Impl>();
    child->file = impl_->file;
    child->prefix = impl_->Name(key) + "[" + std::to_string(i) + "].";
    child->node = value[i];
    child->line = LineOf(value[i]);
    impl_->children.push_back(child);
    sections.push_back(Section(child));
  }
  return sections;
}

std::vector<std::string> Section::Keys() const {
  std::vector<std::string> keys;
  if (impl_->node.IsDefined() && impl_->node.IsMap()) {
    for (const auto& entry : impl_->node) keys.push_back(entry.first.Scalar());
  }
  return keys;
}

bool Section::IsScalar(std::string_view key) const {
  return Has(key) && impl_->Get(key).IsScalar();
}

void Section::RejectUnknownKeys() const {
  if (impl_->node.IsDefined() && impl_->node.IsMap()) {
    for (const auto& entry : impl_->node) {
      const std::string key = entry.first.Scalar();
      if (impl_->asked.contains(key)) continue;
      for (const std::string& known : impl_->asked) {
        if (Stem(known) == Stem(key) && known.find('_') != std::string::npos) {
          impl_->Fail(key, LineOf(entry.first),
                      "wrong unit, expected '" + impl_->Name(known) + "'");
        }
      }
      impl_->Fail(key, LineOf(entry.first),
                  "unknown, expected one of " + types::Joined(std::vector<std::string>(
                                                    impl_->asked.begin(), impl_->asked.end())));
    }
  }
  for (const auto& child : impl_->children) Section(child).RejectUnknownKeys();
}

void Section::Fail(std::string_view key, const std::string& message) const {
  const YAML::Node value = impl_->Get(key);
  impl_->Fail(key, LineOf(value), message);
}

const std::filesystem::path& Section::file() const { return impl_->file; }
int Section::line() const { return impl_->line; }

namespace {

[[noreturn]] void FailOnFile(const std::filesystem::path& path, const std::string& what,
                             int error) {
  throw UsageError(path.string() + ": " + what + ": " + std::strerror(error));
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  WholeFile file(path);
  std::string reason = file.Write(content);
  if (reason.empty()) reason = file.Commit();
  if (!reason.empty()) throw UsageError(path.string() + ": cannot be written: " + reason);
}

void SyncFolderOf(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.parent_path();
  const std::filesystem::path folder = parent.empty() ? "." : parent;
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) FailOnFile(folder, "cannot be opened", errno);
  const bool synced = ::fsync(descriptor) == 0;
  const int error = errno;
  ::close(descriptor);
  if (!synced) FailOnFile(folder, "cannot be written to disk", error);
}

std::string ReadFile(const std::filesystem::path& path, std::uintmax_t limit) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) FailOnFile(path, "cannot be read", errno);
  const std::unique_ptr<const int, void (*)(const int*)> closed(&descriptor,
                                                                [](const int* d) { ::close(*d); });
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) FailOnFile(path, "cannot be read", errno);
  if (!S_ISREG(info.st_mode) && !S_ISFIFO(info.st_mode)) {
    throw UsageError(path.string() + ": is a " + (S_ISDIR(info.st_mode) ? "folder" : "device") +
                     ", expected a file");
  }
  std::string content;
  std::array<char, 1u << 16> block;
  while (true) {
    const ssize_t got = ::read(descriptor, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) FailOnFile(path, "cannot be read", errno);
    if (got == 0) return content;
    content.append(block.data(), static_cast<std::size_t>(got));
    if (content.size() > limit) {
      throw UsageError(path.string() + ": has more than " + std::to_string(limit) +
                       " bytes, expected a smaller file");
    }
  }
}

}  // namespace sinew::config
