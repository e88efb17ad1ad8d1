#include "tools/view/places.h"

#include <algorithm>
#include <map>

namespace sinew::live {

std::uint64_t Places::Take(std::string owner, std::size_t weight, std::function<void()> close) {
  while (!entries_.empty() && taken_ + weight > most_) {
    const auto loser = ToClose(owner, weight);
    const std::function<void()> close_loser = std::move(loser->close);
    taken_ -= loser->weight;
    entries_.erase(loser);
    close_loser();
  }
  taken_ += weight;
  entries_.push_back({next_, std::move(owner), weight, std::move(close)});
  return next_++;
}

void Places::Leave(std::uint64_t number) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [number](const Entry& entry) { return entry.number == number; });
  if (found == entries_.end()) return;
  taken_ -= found->weight;
  entries_.erase(found);
}

std::list<Places::Entry>::iterator Places::ToClose(const std::string& owner, std::size_t weight) {
  std::map<std::string, std::size_t> parts = {{owner, weight}};
  for (const Entry& entry : entries_) parts[entry.owner] += entry.weight;
  return std::max_element(
      entries_.begin(), entries_.end(),
      [&parts](const Entry& a, const Entry& b) { return parts[a.owner] < parts[b.owner]; });
}

}  // namespace sinew::live
