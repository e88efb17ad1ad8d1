// A socket of another user in a place where a program looks for its own. Needs root.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>

#include "components/base/config/descriptor.h"
#include "components/base/config/unix_socket.h"

namespace sinew::testing {

inline constexpr uid_t kStranger = 65534;

// A listening socket of this user at that path, as a process that connects sees it.
inline config::Descriptor ListenAs(uid_t user, const std::filesystem::path& path,
                                   int type = SOCK_STREAM) {
  const auto address = *config::SocketAddress(path);
  config::Descriptor socket(::socket(AF_UNIX, type | SOCK_CLOEXEC, 0));
  EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::chown(path.c_str(), user, static_cast<gid_t>(-1)), 0);
  EXPECT_EQ(::seteuid(user), 0);
  EXPECT_EQ(::listen(socket.get(), 4), 0);
  EXPECT_EQ(::seteuid(0), 0);
  return socket;
}

}  // namespace sinew::testing
