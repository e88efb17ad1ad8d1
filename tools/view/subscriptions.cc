#include "tools/view/subscriptions.h"

#include <algorithm>

namespace sinew::live {

namespace {

std::string NumberText(SubscriptionNumber number) {
  return std::to_string(static_cast<std::uint32_t>(number));
}

}  // namespace

std::vector<std::string> Subscriptions::Add(const Subscribe& request) {
  std::vector<std::string> problems;
  for (const Subscribe::Item& item : request.items) {
    const auto number = static_cast<std::uint32_t>(item.channel);
    if (number < 1 || number > by_channel_.size()) {
      problems.push_back("subscribe: no channel " + std::to_string(number) + ", expected 1 to " +
                         std::to_string(by_channel_.size()));
    } else if (channels_.size() >= most()) {
      problems.push_back("subscribe: " + NumberText(item.subscription) +
                         " is one too many, expected " + std::to_string(most()) + " at most");
    } else if (!channels_.emplace(item.subscription, item.channel).second) {
      problems.push_back("subscribe: subscription " + NumberText(item.subscription) +
                         " is there already, expected another id");
    } else {
      by_channel_[number - 1].push_back(item.subscription);
    }
  }
  return problems;
}

std::vector<std::string> Subscriptions::Remove(const Unsubscribe& request) {
  std::vector<std::string> problems;
  for (const SubscriptionNumber subscription : request.subscriptions) {
    const auto found = channels_.find(subscription);
    if (found == channels_.end()) {
      problems.push_back("unsubscribe: no subscription " + NumberText(subscription));
      continue;
    }
    auto& list = by_channel_[static_cast<std::uint32_t>(found->second) - 1];
    list.erase(std::find(list.begin(), list.end(), subscription));
    channels_.erase(found);
  }
  return problems;
}

const std::vector<SubscriptionNumber>& Subscriptions::Of(ChannelNumber channel) const {
  return by_channel_.at(static_cast<std::uint32_t>(channel) - 1);
}

}  // namespace sinew::live
