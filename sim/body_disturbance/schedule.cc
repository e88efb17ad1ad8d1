#include "sim/body_disturbance/schedule.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::body_disturbance {

namespace {

template <class Entry>
void CheckIntervals(const std::vector<Entry>& entries, const std::string& what) {
  std::vector<Interval> intervals;
  for (const Entry& entry : entries) {
    const Interval& when = entry.when;
    if (!(when.at_s >= 0.0) || !std::isfinite(when.at_s) || !(when.until_s > when.at_s)) {
      throw std::invalid_argument("a " + what + " acts from " + std::to_string(when.at_s) +
                                  " s to " + std::to_string(when.until_s) +
                                  " s, expected a begin from 0 on and an end after it");
    }
    intervals.push_back(when);
  }
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.at_s < b.at_s; });
  for (std::size_t i = 1; i < intervals.size(); ++i) {
    if (intervals[i].at_s >= intervals[i - 1].until_s) continue;
    throw std::invalid_argument("two of kind " + what + " act at " +
                                std::to_string(intervals[i].at_s) + " s, expected one at a time");
  }
}

template <class Entry>
const Entry* ActingIn(const std::vector<Entry>& entries, std::uint64_t tick, double period_s) {
  const auto k = static_cast<double>(tick);
  const auto acts = [&](const Entry& entry) {
    return std::round(entry.when.at_s / period_s) <= k &&
           k < std::round(entry.when.until_s / period_s);
  };
  const auto found = std::find_if(entries.begin(), entries.end(), acts);
  return found == entries.end() ? nullptr : &*found;
}

void Put(const Payload& payload, provider::BodyDisturbance* disturbance) {
  disturbance->payload_link = payload.link;
  disturbance->payload_kg = payload.mass_kg;
  disturbance->payload_m = payload.place_m;
}

void Put(const Push& push, provider::BodyDisturbance* disturbance) {
  disturbance->push_link = push.link;
  disturbance->push_force_N = push.force_N;
  disturbance->push_m = push.place_m;
}

template <class Entry>
void RequirePossible(const Entry& entry) {
  provider::BodyDisturbance disturbance;
  Put(entry, &disturbance);
  if (provider::IsPossible(disturbance)) return;
  throw std::invalid_argument("what acts on link '" + entry.link +
                              "' has a value that is not finite, or a mass below 0");
}

}  // namespace

Schedule::Schedule(std::vector<Payload> payloads, std::vector<Push> pushes)
    : payloads_(std::move(payloads)), pushes_(std::move(pushes)) {
  CheckIntervals(payloads_, "payload");
  CheckIntervals(pushes_, "push");
  for (const Payload& payload : payloads_) RequirePossible(payload);
  for (const Push& push : pushes_) RequirePossible(push);
}

provider::BodyDisturbance Schedule::At(std::uint64_t ticks_since_start, double period_s) const {
  provider::BodyDisturbance disturbance;
  if (const Payload* payload = ActingIn(payloads_, ticks_since_start, period_s)) {
    Put(*payload, &disturbance);
  }
  if (const Push* push = ActingIn(pushes_, ticks_since_start, period_s)) {
    Put(*push, &disturbance);
  }
  return disturbance;
}

}  // namespace sinew::body_disturbance
