// Strict reading of YAML configuration, below fields.h: every key is asked for, units are in the
// keys, and whatever is left over is an error. A message is one line: "FILE:LINE: key 'a.b': what
// is wrong, expected
// ...". Throws UsageError (exit code 2) for everything a user can get wrong. Not for loops: set-up
// only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sinew {

// Bad input of a user: options, configuration, data files. Programs print it in one line and exit
// with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

namespace config {

struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};
inline constexpr Range kPositive{std::numeric_limits<double>::min()};
inline constexpr Range kNotNegative{0.0};

// A mapping (or one entry of a sequence) of a YAML file. Copyable; keeps the document alive.
class Section {
 public:
  // Reads a file and checks its `schema` key. Names the file when it is absent, unreadable or no
  // YAML.
  static Section Load(const std::filesystem::path& path, std::string_view schema);
  // The same for text that is already here; `name` stands for the file in messages.
  static Section Parse(const std::string& text, const std::string& name, std::string_view schema);
  // An empty section, so that defaults apply when no file was given.
  static Section Empty(const std::string& name);

  bool Has(std::string_view key) const;

  // Finite and in range. With a unit of time in the key at most a century (types/seconds.h).
  double Number(std::string_view key, Range range = {}) const;
  std::int64_t Integer(std::string_view key, Range range = {}) const;
  bool BoolOr(std::string_view key, bool fallback) const;
  std::string Text(std::string_view key) const;
  // One of the allowed words; the message lists them.
  std::string Choice(std::string_view key, const std::vector<std::string>& allowed) const;
  std::vector<double> Numbers(std::string_view key, Range range = {}) const;
  std::vector<std::int64_t> Integers(std::string_view key, Range range = {}) const;
  std::vector<std::string> TextsOr(std::string_view key, std::vector<std::string> fallback) const;
  // A path; relative ones are relative to this file. Must exist.
  std::filesystem::path ExistingPath(std::string_view key) const;

  Section Child(std::string_view key) const;  // a mapping; must be there
  Section ChildOrEmpty(std::string_view key) const;
  std::vector<Section> List(std::string_view key) const;  // sequence of mappings; must be there
  std::vector<std::string> Keys() const;  // in file order; counts as asking for none
  bool IsScalar(std::string_view key) const;

  // Throws for the first key of this section (and of children asked for) that was not asked for;
  // says the known keys, and when the key differs only by its unit says which unit was expected.
  void RejectUnknownKeys() const;

  // Throws a UsageError at this key's line. For checks that span keys.
  [[noreturn]] void Fail(std::string_view key, const std::string& message) const;

  const std::filesystem::path& file() const;
  int line() const;

 private:
  struct Impl;
  explicit Section(std::shared_ptr<Impl> impl);
  std::int64_t ToInteger(std::string_view key, double number) const;
  std::shared_ptr<Impl> impl_;
};

// Writes a file as a whole or not at all (whole_file.h). Throws UsageError naming the path and the
// system's reason.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

// After WriteFileAtomically or a removal: what has changed in the file's folder is on disk when
// this returns, and outlives a power cut. Throws UsageError naming the folder and the system's
// reason.
void SyncFolderOf(const std::filesystem::path& path);

// Limits of files that are read whole, so that an endless or a wrong one is an error and not all of
// the memory. A configuration, URDF, deployment, model or table of weights: what a recording
// attaches at most, so that every file that a run depends on is in its recording.
inline constexpr std::uintmax_t kLargestText = 16u << 20;
// Measured data, meshes and logs of a bus: a day at 240 Hz with 20 columns of 10 characters.
inline constexpr std::uintmax_t kLargestData = std::uintmax_t{4} << 30;

// Reads a whole file, or a pipe to its end; throws UsageError naming the path, also for devices and
// for more bytes than the limit.
std::string ReadFile(const std::filesystem::path& path, std::uintmax_t limit = kLargestText);

}  // namespace config
}  // namespace sinew
