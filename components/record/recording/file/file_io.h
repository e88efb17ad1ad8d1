// Files as ends of a recording. Short writes, a full disk and failing closes are errors.
#pragma once

#include <filesystem>

#include "components/base/config/descriptor.h"
#include "components/base/config/whole_file.h"
#include "components/record/recording/io.h"

namespace sinew::recording {

enum class Existing { kRefuse, kReplace };

// Writes straight into the file, so that what a killed program wrote is there. A regular file is
// locked (flock) while it is written: a second writer is refused before it changes anything.
class FileSink : public ByteSink {
 public:
  // Throws UsageError when the file cannot be made, or is there and must not be replaced.
  FileSink(const std::filesystem::path& path, Existing existing);
  ~FileSink() override;
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  IoStatus Write(std::span<const std::byte> bytes) override;
  IoStatus Sync();   // what was written is on the disk
  IoStatus Close();  // flushes to the disk

 private:
  int descriptor_ = -1;
};

// Throws UsageError for what may not be removed for a new file: no plain file, or one that a
// FileSink of any process is writing.
void RequireReplaceable(const std::filesystem::path& path);

// Writes a file as a whole or not at all (config::WholeFile).
class WholeFileSink : public ByteSink {
 public:
  explicit WholeFileSink(const std::filesystem::path& path) : file_(path) {}  // throws UsageError
  IoStatus Write(std::span<const std::byte> bytes) override;
  IoStatus Commit();

 private:
  config::WholeFile file_;
};

class FileSource : public ByteSource {
 public:
  explicit FileSource(const std::filesystem::path& path);  // throws UsageError

  std::uint64_t size() const override { return size_; }
  IoStatus Read(std::uint64_t offset, std::span<std::byte> bytes) override;

 private:
  config::Descriptor descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace sinew::recording
