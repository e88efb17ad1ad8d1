// Folders of the host that are empty for one test: what root's programs make there is seen by
// nobody else, and gone with the test.
#pragma once

#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <initializer_list>

namespace sinew::testing {

// This thread and the processes that it starts have them. False: it may not mount (not root).
inline bool HasOwnFolders(std::initializer_list<const char*> folders) {
  return ::unshare(CLONE_NEWNS) == 0 &&
         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         std::all_of(folders.begin(), folders.end(), [](const char* folder) {
           return ::mount("none", folder, "tmpfs", 0, "mode=0755") == 0;
         });
}

}  // namespace sinew::testing
