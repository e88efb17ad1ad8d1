#include "components/robot/estop/socket_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "components/base/config/config.h"
#include "components/base/config/unix_socket.h"

namespace sinew::estop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "/run/sinew";

std::string LoginFolder() { return "/run/user/" + std::to_string(::geteuid()); }

std::vector<fs::path> Folders() {
  std::vector<fs::path> folders{kFolder};
  if (::geteuid() != 0) folders.push_back(fs::path(LoginFolder()) / "sinew");
  return folders;
}

}  // namespace

std::string RefusalToListen(const SocketFolder& folder, const fs::path& socket) {
  if (!folder.problem.empty()) return folder.problem;
  if (folder.owner == 0 || folder.owner == ::geteuid() || socket.parent_path() == kFolder) {
    return "";
  }
  return "its folder belongs to user " + std::to_string(folder.owner) +
         ", expected root or this process' user, " + std::to_string(::geteuid());
}

fs::path DefaultSocket(const std::string& name, int domain_id) {
  const std::string file =
      "estop-" + config::FileNamePart(name) + "-" + std::to_string(domain_id) + ".sock";
  for (const fs::path& folder : Folders()) {
    (void)::mkdir(folder.c_str(), 0755);
    if (::access(folder.c_str(), W_OK) == 0) return folder / file;
  }
  throw UsageError(std::string("estop socket: this user can write neither to ") + kFolder +
                   " nor to " + LoginFolder() + " (of a login); expected 'sudo install -d -o " +
                   std::to_string(::geteuid()) + " " + kFolder +
                   "', or estop: {socket: PATH} in the configuration");
}

std::vector<fs::path> SocketsToPress(const std::vector<fs::path>& named,
                                     std::optional<int> domain_id) {
  if (!named.empty()) return named;
  const std::string end = (domain_id ? "-" + std::to_string(*domain_id) : "") + ".sock";
  std::vector<fs::path> sockets;
  for (const fs::path& folder : Folders()) {
    std::error_code ignored;
    for (fs::directory_iterator entry(folder, ignored), last; entry != last;
         entry.increment(ignored)) {
      const std::string file = entry->path().filename().string();
      if (file.starts_with("estop-") && file.ends_with(end)) sockets.push_back(entry->path());
    }
  }
  std::sort(sockets.begin(), sockets.end());
  return sockets;
}

}  // namespace sinew::estop
