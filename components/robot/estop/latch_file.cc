#include "components/robot/estop/latch_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "components/base/config/config.h"
#include "components/base/types/printable.h"

namespace sinew::estop {
namespace {

constexpr std::string_view kLatchSchema = "sinew-estop-latch/1\n";

// One line: what is on the wire may hold anything.
std::string OneLine(std::string_view text) {
  text = text.substr(0, 200);
  while (text.ends_with('\n') || text.ends_with(' ')) text.remove_suffix(1);
  return types::Printable(text);
}

}  // namespace

LatchFile::State LatchFile::Read() const {
  struct stat info {};
  if (::stat(path_.c_str(), &info) != 0) {
    const int error = errno;
    struct stat folder {};
    if (error == ENOENT && ::stat(path_.parent_path().c_str(), &folder) == 0) return {};
    return {.latched = true, .why = path_.string() + ": cannot be read: " + std::strerror(error)};
  }
  try {
    const std::string text = config::ReadFile(path_);
    if (!text.starts_with(kLatchSchema)) {
      return {.latched = true, .why = path_.string() + ": unexpected contents"};
    }
    return {.latched = true,
            .valid = true,
            .why = OneLine(std::string_view(text).substr(kLatchSchema.size()))};
  } catch (const UsageError& error) {
    return {.latched = true, .why = error.what()};
  }
}

config::Descriptor LatchFile::Lock() const {
  const std::string path = path_.string() + ".lock";  // the latch itself comes and goes
  config::Descriptor lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (lock.get() >= 0 && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    throw UsageError("estop latch '" + path_.string() +
                     "': another state provider of this host keeps its estop there; expected "
                     "another --name, or another key estop.latch");
  }
  return lock;
}

std::string LatchFile::Write(std::string_view reason) const {
  try {
    config::WriteFileAtomically(path_, std::string(kLatchSchema) + OneLine(reason) + "\n");
    config::SyncFolderOf(path_);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

std::string LatchFile::Remove() const {
  if (::unlink(path_.c_str()) != 0 && errno != ENOENT) {
    return path_.string() + ": cannot be removed: " + std::strerror(errno);
  }
  try {
    config::SyncFolderOf(path_);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace sinew::estop
