// SIGUSR1 as a request to write what a ring holds. One object at a time; any thread asks it.
#pragma once

#include <csignal>

namespace sinew::logger {

class DumpSignal {
 public:
  DumpSignal();   // from here on the signal does not end the process
  ~DumpSignal();  // what was before
  DumpSignal(const DumpSignal&) = delete;
  DumpSignal& operator=(const DumpSignal&) = delete;

  // Whether the signal came since the last call.
  static bool Take() noexcept;

 private:
  struct sigaction before_ {};
};

}  // namespace sinew::logger
