// The right to command a bus: one process of a host at a time, by the kernel's own book-keeping.
//
// It is the name of a Unix socket without a file (abstract namespace): it belongs to the network
// namespace that the CAN interface belongs to, whoever its user is, and ends with its process,
// however that ends. Two hosts on one bus do not see each other's names: they hear each other's
// frames (bridge/joints/faults.h, kAnotherMaster).
#pragma once

#include <string>

#include "components/base/config/descriptor.h"

namespace sinew::can {

class BusMaster {
 public:
  // bus: an interface, or a virtual bus (its socket's path). Throws UsageError naming the process
  // that has it.
  explicit BusMaster(const std::string& bus);

 private:
  config::Descriptor socket_;
};

}  // namespace sinew::can
