// The parts of a node. Readers and writers keep them alive, and may outlive the Node itself.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "components/topics/node/composition.h"
#include "components/topics/node/discovery.h"
#include "components/topics/node/node.h"
#include "components/topics/node/ownership_keeper.h"
#include "components/topics/node/participant.h"
#include "components/topics/node/reader_impl.h"
#include "components/topics/node/status.h"
#include "components/topics/node/wake_signal.h"

namespace sinew::node::internal {

struct NodeImpl : public std::enable_shared_from_this<NodeImpl> {
  NodeImpl(const Options& node_options, const std::vector<std::string>& joint_names)
      : options(node_options),
        ownership(*this),
        discovery(signal, [this] { ownership.Notify(); }),
        status(RoleOf(options), options.name) {
    if (!apart()) participant.emplace(options, joint_names, &discovery);
  }

  // No DDS: composition.h.
  bool apart() const { return options.composition != nullptr && options.composition->apart(); }

  const Options options;
  WakeSignal signal;
  OwnershipKeeper ownership;
  Discovery discovery;
  std::optional<Participant> participant;  // none: apart
  // Its writer and the raw readers hold a pointer to this: Node's destructor ends them.
  Status status;
  std::vector<std::unique_ptr<ReaderImpl>> raw_readers;

  // Readers of EXCLUSIVE topics, which want to know the period.
  std::mutex owned_readers_mutex;
  std::vector<ReaderImpl*> owned_readers;
  std::chrono::nanoseconds period{0};
};

}  // namespace sinew::node::internal
