#include "components/record/recording/file/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "components/base/config/config.h"

namespace sinew::recording {
namespace {

std::string Reason() { return std::strerror(errno); }

}  // namespace

FileSink::FileSink(const std::filesystem::path& path, Existing existing) {
  const int flags =
      O_WRONLY | O_CREAT | O_CLOEXEC | (existing == Existing::kRefuse ? O_EXCL : O_TRUNC);
  descriptor_ = ::open(path.c_str(), flags, 0644);
  if (descriptor_ >= 0) return;
  if (errno == EEXIST) {
    throw UsageError(path.string() + ": is there already, expected a new name (or --overwrite)");
  }
  throw UsageError(path.string() + ": cannot be written: " + Reason());
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

WholeFileSink::WholeFileSink(const std::filesystem::path& path)
    : path_(path),
      temporary_(path.string() + ".part" + std::to_string(::getpid())),
      sink_(temporary_, Existing::kReplace) {}

WholeFileSink::~WholeFileSink() {
  if (!committed_) ::unlink(temporary_.c_str());
}

IoStatus WholeFileSink::Commit() {
  if (IoStatus status = sink_.Close(); !status.ok()) return status;
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return IoStatus::Failed(Reason());
  committed_ = true;
  return IoStatus::Ok();
}

FileSource::FileSource(const std::filesystem::path& path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw UsageError(path.string() + ": cannot be read: " + Reason());
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0 || !S_ISREG(info.st_mode)) {
    const std::string reason = S_ISDIR(info.st_mode) ? "is a folder" : "is no plain file";
    ::close(descriptor_);
    throw UsageError(path.string() + ": " + reason + ", expected a recording");
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

FileSource::~FileSource() { ::close(descriptor_); }

IoStatus FileSource::Read(std::uint64_t offset, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return IoStatus::Failed(Reason());
    if (got == 0) return IoStatus::Failed("the file became shorter");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return IoStatus::Ok();
}

}  // namespace sinew::recording
