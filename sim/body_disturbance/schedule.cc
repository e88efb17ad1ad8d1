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

void Put(const LostDrive& lost, provider::BodyDisturbance* disturbance) {
  disturbance->lost_drive = lost.joint;
}

void Put(const LostFriction& lost, provider::BodyDisturbance* disturbance) {
  disturbance->lost_friction = lost.share;
}

template <class Entry>
void RequirePossible(const std::vector<Entry>& entries, const std::string& what) {
  CheckIntervals(entries, what);
  for (const Entry& entry : entries) {
    provider::BodyDisturbance disturbance;
    Put(entry, &disturbance);
    if (provider::IsPossible(disturbance)) continue;
    throw std::invalid_argument(
        "the " + what + " from " + std::to_string(entry.when.at_s) +
        " s on has a value that is not finite, a mass below 0, or a share outside 0 to 1");
  }
}

template <class Entry>
void PutActing(const std::vector<Entry>& entries, std::uint64_t tick, double period_s,
               provider::BodyDisturbance* disturbance) {
  if (const Entry* entry = ActingIn(entries, tick, period_s)) Put(*entry, disturbance);
}

}  // namespace

Schedule::Schedule(std::vector<Payload> payloads, std::vector<Push> pushes,
                   std::vector<LostDrive> lost_drives, std::vector<LostFriction> lost_frictions)
    : payloads_(std::move(payloads)),
      pushes_(std::move(pushes)),
      lost_drives_(std::move(lost_drives)),
      lost_frictions_(std::move(lost_frictions)) {
  RequirePossible(payloads_, "payload");
  RequirePossible(pushes_, "push");
  RequirePossible(lost_drives_, "lost drive");
  RequirePossible(lost_frictions_, "lost friction");
}

provider::BodyDisturbance Schedule::At(std::uint64_t ticks_since_start, double period_s) const {
  provider::BodyDisturbance disturbance;
  PutActing(payloads_, ticks_since_start, period_s, &disturbance);
  PutActing(pushes_, ticks_since_start, period_s, &disturbance);
  PutActing(lost_drives_, ticks_since_start, period_s, &disturbance);
  PutActing(lost_frictions_, ticks_since_start, period_s, &disturbance);
  return disturbance;
}

}  // namespace sinew::body_disturbance
