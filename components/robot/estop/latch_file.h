// The latch of an estop on disk: while its file is there, a state provider starts ESTOPPED.
//
// The safe answer to every doubt is "latched": a file that cannot be read, has unexpected contents,
// or whose folder is missing (a disk that is not mounted) stops the robot as the file itself does.
//
// Thread: one at a time; every call may wait for the disk.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "components/base/config/descriptor.h"

namespace sinew::estop {

class LatchFile {
 public:
  explicit LatchFile(std::filesystem::path path) : path_(std::move(path)) {}

  struct State {
    bool latched = false;
    bool valid = false;  // a latch file as Write() makes it
    std::string why;     // latched: the reason in the file, or what is wrong with it
  };
  State Read() const;

  // Held by a state provider while it runs: another one's reset would remove this one's estop.
  // Nothing: its folder cannot be written to, nor then the latch. Throws UsageError: another has
  // it.
  config::Descriptor Lock() const;

  // On disk when this returns: file and folder are synced. What is wrong; empty: done.
  [[nodiscard]] std::string Write(std::string_view reason) const;
  // The same. A file that is not there is removed already.
  [[nodiscard]] std::string Remove() const;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace sinew::estop
