#include "tools/view/topic_rates.h"

#include <stdexcept>
#include <string>

namespace sinew::live {

void TopicRates::Sample(const std::vector<std::uint64_t>& counts, std::int64_t now_ns) {
  if (counts.size() != topics_.size()) {
    throw std::invalid_argument(std::to_string(counts.size()) + " counts, expected " +
                                std::to_string(topics_.size()));
  }
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - sampled_ns_);
  const bool first = sampled_ns_ < 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::uint64_t more = counts[i] - topics_[i].messages;
    topics_[i].rate_Hz = first || elapsed_s <= 0.0 ? 0.0 : static_cast<double>(more) / elapsed_s;
    topics_[i].messages = counts[i];
    if (more > 0) topics_[i].news_ns = now_ns;
  }
  sampled_ns_ = now_ns;
}

}  // namespace sinew::live
