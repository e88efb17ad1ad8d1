// Folders of Unix sockets, and whose socket counts there: at predictable paths another user's may
// stand.
//
// Not for loops: reads the file system and allocates.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace sinew::config {

// The folder of a socket.
struct SocketFolder {
  uid_t owner = 0;
  std::string problem;  // empty: a folder to which nobody but its owner and root can write

  // A user who may open a socket there, or answer: root, this process' user, the folder's owner.
  bool Admits(uid_t user) const;
};
SocketFolder FolderOf(const std::filesystem::path& socket);

// The path of a socket of that name for this user's own programs: in $XDG_RUNTIME_DIR, else in
// /tmp/sinew-UID, which is made; either counts only where it is this user's and nobody else may
// write to it. Throws UsageError: neither is.
std::filesystem::path PrivateSocket(const std::string& name);

}  // namespace sinew::config
