#include "tools/rerun/differences.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "components/base/types/joints.h"
#include "tools/rerun/message_diff.h"

namespace sinew::rerun {
namespace {

constexpr std::string_view kCountSuffix = ".count";

// The field that a leaf belongs to: a value of a long list belongs to the list.
class FieldNames {
 public:
  std::string Of(const Leaf& leaf) {
    if (leaf.field.ends_with(kCountSuffix)) {
      list_ = leaf.field.substr(0, leaf.field.size() - kCountSuffix.size());
      long_list_ = leaf.number > types::kMaxJoints;
      return leaf.field;
    }
    const bool of_list = !list_.empty() && leaf.field.starts_with(list_ + "[");
    return of_list && long_list_ ? list_ + "[]" : leaf.field;
  }

 private:
  std::string list_;
  bool long_list_ = false;
};

}  // namespace

void Differences::Add(const std::string& topic, std::uint64_t tick, const recording::IdlType& type,
                      std::span<const std::byte> recorded, std::span<const std::byte> rerun) {
  std::vector<Leaf> before, after;
  try {
    before = LeavesOf(type, recorded);
    after = LeavesOf(type, rerun);
  } catch (const recording::CdrError&) {
    return;
  }
  FieldNames names;
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    if (before[i].field != after[i].field) return;  // behind a list of another length
    const std::string field = names.Of(before[i]);
    if (before[i].text == after[i].text) continue;
    Sum& sum = sums_[{topic, field}];
    FieldSummary& summary = sum.summary;
    if (sum.values == 0) {
      summary.topic = topic;
      summary.field = field;
      summary.first_tick = tick;
      sum.order = i;
    }
    if (sum.values == 0 || sum.last_tick != tick) ++summary.ticks;
    sum.last_tick = tick;
    ++sum.values;
    const double difference = after[i].number - before[i].number;
    sum.squares += difference * difference;
    if (std::abs(difference) > std::abs(summary.largest)) {
      summary.largest = difference;
      summary.largest_tick = tick;
    }
  }
}

std::vector<FieldSummary> Differences::Summaries() const {
  std::vector<const Sum*> sums;
  for (const auto& [name, sum] : sums_) sums.push_back(&sum);
  std::sort(sums.begin(), sums.end(), [](const Sum* a, const Sum* b) {
    return std::pair(a->summary.topic, a->order) < std::pair(b->summary.topic, b->order);
  });
  std::vector<FieldSummary> summaries;
  for (const Sum* sum : sums) {
    FieldSummary summary = sum->summary;
    summary.rms = std::sqrt(sum->squares / static_cast<double>(sum->values));
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace sinew::rerun
