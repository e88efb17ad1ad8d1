// Unix sockets in the file system: their addresses, folders, and who is at the other end: at
// predictable paths another user's may stand.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cctype>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>

namespace sinew::config {

// Nothing: the path does not fit into an address.
inline std::optional<sockaddr_un> SocketAddress(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.size() >= sizeof address.sun_path) return std::nullopt;
  std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
  return address;
}

// A name as a part of a file's name: '/' and whatever else is no letter, digit, '-' or '.' is '_'.
inline std::string FileNamePart(std::string name) {
  for (char& c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.';
    if (!plain) c = '_';
  }
  return name;
}

// The process at the other end of a connected socket: of a client the one that listens there.
inline ucred PeerOf(int socket) {
  ucred peer{.pid = 0, .uid = static_cast<uid_t>(-1), .gid = static_cast<gid_t>(-1)};
  socklen_t size = sizeof peer;
  (void)::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size);
  return peer;
}

// The folder of a socket. Reads the file system and allocates: not for loops.
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
