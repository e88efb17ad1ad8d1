#include "components/record/recording/file/file_io.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "components/base/config/config.h"

namespace sinew::recording {
namespace {

std::string Reason() { return std::strerror(errno); }

IoStatus ToStatus(std::string reason) {
  return reason.empty() ? IoStatus::Ok() : IoStatus::Failed(std::move(reason));
}

constexpr char kWritten[] = "is being written by another process, expected another name";

// The file for this process alone and empty: locked until it is closed, and emptied only then.
// Pipes and devices are as they are. Returns what is wrong.
std::string Claim(int descriptor) {
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return "cannot be written: " + Reason();
  if (S_ISBLK(info.st_mode)) return "is a block device, expected the name of a file";
  if (!S_ISREG(info.st_mode)) return "";
  // A file system without locks is no reason not to record.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return kWritten;
  return ::ftruncate(descriptor, 0) == 0 ? "" : "cannot be written: " + Reason();
}

}  // namespace

FileSink::FileSink(const std::filesystem::path& path, Existing existing) {
  const int flags = O_WRONLY | O_CREAT | O_CLOEXEC | (existing == Existing::kRefuse ? O_EXCL : 0);
  descriptor_ = ::open(path.c_str(), flags, 0644);
  if (descriptor_ < 0) {
    if (errno == EEXIST) {
      throw UsageError(path.string() + ": is there already, expected a new name (or --overwrite)");
    }
    throw UsageError(path.string() + ": cannot be written: " + Reason());
  }
  const std::string problem = Claim(descriptor_);
  if (problem.empty()) return;
  ::close(descriptor_);
  throw UsageError(path.string() + ": " + problem);
}

void RequireReplaceable(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return;  // a link to nothing, too
  if (!S_ISREG(info.st_mode)) {
    throw UsageError(path.string() + ": is no plain file, expected one to replace");
  }
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // not ours to read, and so not ours to lock
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  if (locked) throw UsageError(path.string() + ": " + kWritten);
}

FileSink::~FileSink() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

IoStatus FileSink::Write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return IoStatus::Failed(Reason());
    if (written == 0) return IoStatus::Failed("nothing could be written");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return IoStatus::Ok();
}

IoStatus FileSink::Sync() {
  // Pipes and devices cannot be synced.
  if (::fdatasync(descriptor_) == 0 || errno == EINVAL || errno == EROFS) return IoStatus::Ok();
  return IoStatus::Failed(Reason());
}

IoStatus FileSink::Close() {
  if (descriptor_ < 0) return IoStatus::Ok();
  const bool synced =
      ::fsync(descriptor_) == 0 || errno == EINVAL || errno == EROFS;  // pipes cannot be
  const std::string reason = synced ? std::string() : Reason();
  const bool closed = ::close(descriptor_) == 0;
  descriptor_ = -1;
  if (!synced) return IoStatus::Failed(reason);
  if (!closed) return IoStatus::Failed(Reason());
  return IoStatus::Ok();
}

IoStatus WholeFileSink::Write(std::span<const std::byte> bytes) {
  return ToStatus(file_.Write({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}

IoStatus WholeFileSink::Commit() { return ToStatus(file_.Commit()); }

FileSource::FileSource(const std::filesystem::path& path) {
  descriptor_ = config::Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor_.get() < 0) throw UsageError(path.string() + ": cannot be read: " + Reason());
  struct stat info {};
  if (::fstat(descriptor_.get(), &info) != 0 || !S_ISREG(info.st_mode)) {
    const std::string reason = S_ISDIR(info.st_mode) ? "is a folder" : "is no plain file";
    throw UsageError(path.string() + ": " + reason +
                     ", expected a recording (`sinew import` makes one of a bag of ROS 2)");
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

IoStatus FileSource::Read(std::uint64_t offset, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(descriptor_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return IoStatus::Failed(Reason());
    if (got == 0) return IoStatus::Failed("the file became shorter");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return IoStatus::Ok();
}

}  // namespace sinew::recording
