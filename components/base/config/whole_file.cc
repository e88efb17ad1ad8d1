#include "components/base/config/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>

#include "components/base/config/config.h"

namespace sinew::config {

namespace {

namespace fs = std::filesystem;

// Kind of a refused file, by stat(); nothing for one that is written, by itself or in its place.
const char* RefusedKind(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISBLK(mode)) return "a block device";
  if (S_ISSOCK(mode)) return "a socket";
  return nullptr;
}

}  // namespace

fs::path PartPath(const fs::path& path) {
  std::random_device random;  // of the kernel
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), ".part.%08x%08x", static_cast<unsigned>(random()),
                static_cast<unsigned>(random()));
  return path.string() + text.data();
}

WholeFile::WholeFile(const fs::path& path) : path_(path), target_(path) {
  struct stat info {};
  // stat() follows links as open() does, with the kernel's protection of shared folders.
  if (::stat(path.c_str(), &info) == 0) {
    if (const char* kind = RefusedKind(info.st_mode)) {
      throw UsageError(path.string() + ": is " + kind + ", expected the name of a file");
    }
    if (!S_ISREG(info.st_mode)) {
      written_ = path;
      descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
      if (descriptor_ < 0) Fail(errno);
      return;
    }
    std::error_code error;
    if (fs::is_symlink(path, error)) target_ = fs::canonical(path, error);
    if (error) Fail(error.value());
  } else if (errno != ENOENT) {
    Fail(errno);
  }
  written_ = PartPath(target_);
  descriptor_ =
      ::open(written_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor_ < 0) Fail(errno);
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!committed_ && written_ != path_) ::unlink(written_.c_str());
}

void WholeFile::Fail(int error) const {
  throw UsageError(path_.string() + ": cannot be written: " + std::strerror(error));
}

fs::path WholeFile::DescriptorPath() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

std::string WholeFile::Write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor_, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return std::strerror(errno);
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return "";
}

std::string WholeFile::Commit() {
  // Pipes and devices cannot be synced.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) return std::strerror(errno);
  const bool closed = ::close(descriptor_) == 0;
  descriptor_ = -1;
  if (!closed) return std::strerror(errno);
  if (written_ != path_ && ::rename(written_.c_str(), target_.c_str()) != 0) {
    return std::strerror(errno);
  }
  committed_ = true;
  return "";
}

}  // namespace sinew::config
