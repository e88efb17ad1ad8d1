// An output file that appears under its name when it is whole. Everything that replaces files of a
// user goes through this class.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sinew::config {

// Written beside its place under a name that nobody can guess (64 random bits, made with O_EXCL),
// and renamed by Commit. Only a regular file is ever replaced: a link to one stays a link; a pipe
// or a character device, such as /dev/stdout, is written directly, and what is in it stays there
// without a Commit; anything else is refused.
class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);  // throws UsageError naming the path
  ~WholeFile();                                           // removes what was not committed
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  // The system's reason for a failure; empty: none.
  [[nodiscard]] std::string Write(std::string_view content);
  [[nodiscard]] std::string Commit();  // on the disk, and under its name
  // The file, whatever is under its name by now, for writers that open one by a path.
  std::filesystem::path DescriptorPath() const;

 private:
  [[noreturn]] void Fail(int error) const;

  std::filesystem::path path_;     // as the user calls it
  std::filesystem::path target_;   // links resolved
  std::filesystem::path written_;  // target_ itself where it is written directly
  int descriptor_ = -1;
  bool committed_ = false;
};

// The name of a file or folder that is not there: `path` with ".part." and 64 random bits.
std::filesystem::path PartPath(const std::filesystem::path& path);

}  // namespace sinew::config
