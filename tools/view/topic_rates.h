// Rate of each topic, from counts that are read now and then. Pure; not synchronized.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sinew::live {

class TopicRates {
 public:
  explicit TopicRates(std::size_t topics) : topics_(topics) {}

  // counts: messages of each topic since the start; throws std::invalid_argument for another number
  // of topics. Rates are those between this call and the one before; now_ns: a monotonic clock.
  void Sample(const std::vector<std::uint64_t>& counts, std::int64_t now_ns);

  struct Topic {
    std::uint64_t messages = 0;
    double rate_Hz = 0.0;
    std::int64_t news_ns = -1;  // when a call last found new ones; -1: never
  };
  const std::vector<Topic>& topics() const { return topics_; }

 private:
  std::vector<Topic> topics_;
  std::int64_t sampled_ns_ = -1;
};

}  // namespace sinew::live
