// Subscriptions of a client to channels. Not synchronized.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tools/view/protocol.h"

namespace sinew::live {

class Subscriptions {
 public:
  // Channels are numbered from 1 to channel_count.
  explicit Subscriptions(std::size_t channel_count) : by_channel_(channel_count) {}

  // A viewer subscribes to a channel once, one that changes its windows once more before it leaves;
  // each subscription copies the channel's messages into the queue again.
  std::size_t most() const { return 4 * by_channel_.size(); }

  // Returns what was wrong, a line each, for the client; what was right counts all the same.
  std::vector<std::string> Add(const Subscribe& request);
  std::vector<std::string> Remove(const Unsubscribe& request);

  // The client's numbers for a channel; a channel may be subscribed to more than once.
  const std::vector<SubscriptionNumber>& Of(ChannelNumber channel) const;
  std::size_t size() const { return channels_.size(); }

 private:
  std::map<SubscriptionNumber, ChannelNumber> channels_;
  std::vector<std::vector<SubscriptionNumber>> by_channel_;  // index: number - 1
};

}  // namespace sinew::live
