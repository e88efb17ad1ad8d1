// The folder of the estop sockets of a host's state providers: one, /run/sinew, whose owner alone
// (and root) can put a socket there. Nothing here depends on the environment.
//
//     /run/sinew           made by root's programs, and by the systemd units for their user
//     /run/user/UID/sinew  of a user who may not write there and has logged in
//
// A socket is estop-NAME-DOMAIN.sock, of the state provider's name and DDS domain.
//
// Not for loops: reads the file system and allocates.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/unix_socket.h"

namespace sinew::estop {

using config::FolderOf;
using config::SocketFolder;

// Why a state provider of this process may not open its socket in that folder; empty: it may.
// Beside /run/sinew, whose owner is root's choice, it belongs to root or this user.
std::string RefusalToListen(const SocketFolder& folder, const std::filesystem::path& socket);

// The socket of a state provider, in the first of the folders that this process may write to, made
// where it is absent. Throws UsageError: there is none.
std::filesystem::path DefaultSocket(const std::string& name, int domain_id);

// Sockets that a client presses: the named ones, else all of both folders; of one domain, where
// that was chosen.
std::vector<std::filesystem::path> SocketsToPress(const std::vector<std::filesystem::path>& named,
                                                  std::optional<int> domain_id);

}  // namespace sinew::estop
