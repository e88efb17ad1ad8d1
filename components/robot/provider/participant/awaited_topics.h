// The topics of --await joined to the provider's readers, for LockstepWait. Thread: the provider's
// loop; messages of other topics are counted in DDS threads.
#pragma once

#include <string>
#include <vector>

#include "components/robot/provider/participant/command_readers.h"
#include "components/robot/provider/participant/lockstep_wait.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/topics/node/node.h"

namespace sinew::provider {

// The result refers to node, cycle and readers, which must outlive it. Throws UsageError
// (ParseAwaited) and DdsError.
std::vector<AwaitedTopic> MakeAwaitedTopics(const std::vector<std::string>& await, node::Node& node,
                                            const ProviderCycle& cycle, CommandReaders& readers);

}  // namespace sinew::provider
