// The estop of a state provider in its cycle: presses of the socket, the latch on disk, resets.
//
// Thread: the provider's loop; nothing here waits. What waits is in estop::Listener's thread.
#pragma once

#include <functional>
#include <string_view>

#include "components/robot/estop/listener.h"
#include "components/robot/provider/plant.h"
#include "components/robot/provider/provider_cycle.h"

namespace sinew::provider {

class EstopDesk {
 public:
  // Opens socket and latch. A latch that is there: ESTOPPED from now on. `wake` is called by
  // another thread and ends the waits of the loop. Throws UsageError.
  EstopDesk(const estop::Config& config, ProviderCycle& cycle, Plant& plant,
            std::function<void()> wake);

  // Takes the events since the last call: presses stop the robot, and a reset whose latch is gone
  // is finished.
  void Take(std::uint64_t tick);
  // An estop by DDS, and a reset that unlatches first.
  void OnEstop(std::string_view reason);
  void OnReset();

  // The plant's command is made now; and then: has been sent to the plant. Both once a cycle, so
  // that the drives' answer to an estop is noticed.
  void CommandMade() noexcept { covered_ = listener_.taken(); }
  void CommandSent() noexcept;

 private:
  ProviderCycle& cycle_;
  Plant& plant_;
  estop::Listener listener_;
  std::uint64_t covered_ = 0, sent_ = 0;
  std::int64_t sent_ns_ = 0;
  bool resets_ = false;  // waits for the latch to be removed
};

}  // namespace sinew::provider
