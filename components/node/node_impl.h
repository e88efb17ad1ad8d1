// The parts of a node. Readers and writers keep them alive, and may outlive the Node itself.
#pragma once

#include <memory>
#include <vector>

#include "components/node/discovery.h"
#include "components/node/node.h"
#include "components/node/participant.h"
#include "components/node/reader_impl.h"
#include "components/node/status.h"
#include "components/node/wake_signal.h"

namespace sinew::node::internal {

struct NodeImpl {
  explicit NodeImpl(const Options& node_options)
      : options(node_options),
        discovery(signal),
        participant(options, &discovery),
        status(options.component, options.name) {}

  const Options options;
  WakeSignal signal;
  Discovery discovery;
  Participant participant;
  // Its writer and the raw readers hold a pointer to this: Node's destructor ends them.
  Status status;
  std::vector<std::unique_ptr<ReaderImpl>> raw_readers;
};

}  // namespace sinew::node::internal
