#include "components/base/config/unix_socket.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "components/base/config/config.h"
#include "components/base/config/descriptor.h"

namespace sinew::config {

namespace fs = std::filesystem;

bool SocketFolder::Admits(uid_t user) const {
  return user == 0 || user == ::geteuid() || (problem.empty() && user == owner);
}

SocketFolder FolderOf(const fs::path& socket) {
  std::error_code ignored;  // no working folder: none that can be opened
  const std::string folder = fs::absolute(socket, ignored).parent_path().string();
  const Descriptor opened(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat info {};
  if (opened.get() < 0 || ::fstat(opened.get(), &info) != 0) {
    return {.problem = "its folder cannot be opened: " + std::string(std::strerror(errno))};
  }
  if ((info.st_mode & (S_IWGRP | S_IWOTH)) == 0) return {.owner = info.st_uid, .problem = ""};
  return {.owner = info.st_uid,
          .problem = "others may write to its folder, expected one of mode 0755 at most"};
}

fs::path PrivateSocket(const std::string& name) {
  const auto is_own = [](const fs::path& socket) {
    const SocketFolder folder = FolderOf(socket);
    return folder.problem.empty() && folder.owner == ::geteuid();
  };
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && runtime[0] == '/' && is_own(fs::path(runtime) / name)) {
    return fs::path(runtime) / name;
  }
  const fs::path own = "/tmp/sinew-" + std::to_string(::geteuid());
  (void)::mkdir(own.c_str(), S_IRWXU);
  if (is_own(own / name)) return own / name;
  throw UsageError(own.string() + ": expected a folder to which this user alone may write, there " +
                   "or as XDG_RUNTIME_DIR, for its sockets");
}

}  // namespace sinew::config
