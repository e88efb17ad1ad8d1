#include "components/record/logger/latched_samples.h"

#include <algorithm>

namespace sinew::logger {

void LatchedSamples::Keep(const RecordedMessage& message,
                          const std::function<recording::TextMap(const WriterGuid&)>& describe) {
  if (message.malformed || RepeatsOf(message.topic) == Repeats::kNoSession) return;
  if (RepeatsOf(message.topic) == Repeats::kNothing) {
    session_id_ = message.session_id;
    return;
  }
  const auto [entry, is_new] =
      samples_.try_emplace({message.topic, message.origin.writer, message.instance});
  entry->second.sample.message = message;
  entry->second.order = ++order_;
  if (!is_new) return;
  if (describe) entry->second.sample.writer = describe(message.origin.writer);
  if (samples_.size() <= kMost) return;
  samples_.erase(std::min_element(
      samples_.begin(), samples_.end(),
      [](const auto& a, const auto& b) { return a.second.order < b.second.order; }));
}

std::vector<const LatchedSample*> LatchedSamples::Now(
    const std::function<bool(const WriterGuid&)>& is_live) const {
  std::vector<const Entry*> entries;
  for (const auto& [key, entry] : samples_) {
    const RecordedMessage& message = entry.sample.message;
    const bool in_force = RepeatsOf(message.topic) == Repeats::kOfTheSession
                              ? !session_id_ || message.session_id == *session_id_
                              : !is_live || is_live(message.origin.writer);
    if (in_force) entries.push_back(&entry);
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry* a, const Entry* b) { return a->order < b->order; });
  std::vector<const LatchedSample*> samples;
  samples.reserve(entries.size());
  for (const Entry* entry : entries) samples.push_back(&entry->sample);
  return samples;
}

}  // namespace sinew::logger
