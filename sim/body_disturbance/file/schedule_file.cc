#include "sim/body_disturbance/file/schedule_file.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace sinew::body_disturbance {

namespace {

using config::Section;

constexpr std::size_t kLongestName = 64;  // of a link or joint, in sim_body_disturbance

std::array<double, 3> ReadVector(const Section& section, std::string_view key) {
  const std::vector<double> values = section.Numbers(key);
  if (values.size() != 3) {
    section.Fail(key, std::to_string(values.size()) + " numbers, expected x, y, z");
  }
  std::array<double, 3> vector{};
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

std::string ReadName(const Section& section, std::string_view key) {
  std::string name = section.Text(key);
  if (name.empty() || name.size() > kLongestName) {
    section.Fail(key, "'" + name + "', expected a name of 1 to 64 characters");
  }
  return name;
}

}  // namespace

Schedule ReadSchedule(const Section& root) {
  std::vector<Payload> payloads;
  std::vector<Push> pushes;
  std::vector<LostDrive> lost_drives;
  std::vector<LostFriction> lost_frictions;
  for (const Section& entry : root.List("disturbances")) {
    Interval when{.at_s = entry.Number("at_s", config::kNotNegative)};
    if (entry.Has("for_s")) when.until_s = when.at_s + entry.Number("for_s", config::kPositive);
    if (!entry.Has("payload") && !entry.Has("push") && !entry.Has("lost_drive") &&
        !entry.Has("lost_friction")) {
      entry.Fail("at_s", "nothing acts, expected payload, push, lost_drive or lost_friction");
    }
    if (entry.Has("lost_drive")) {
      lost_drives.push_back({.when = when, .joint = ReadName(entry, "lost_drive")});
    }
    if (entry.Has("lost_friction")) {
      lost_frictions.push_back({.when = when, .share = entry.Number("lost_friction", {0.0, 1.0})});
    }
    if (entry.Has("payload")) {
      const Section payload = entry.Child("payload");
      payloads.push_back({.when = when,
                          .link = ReadName(payload, "link"),
                          .mass_kg = payload.Number("mass_kg", config::kPositive),
                          .place_m = ReadVector(payload, "place_m")});
    }
    if (entry.Has("push")) {
      const Section push = entry.Child("push");
      pushes.push_back({.when = when,
                        .link = ReadName(push, "link"),
                        .force_N = ReadVector(push, "force_N"),
                        .place_m = ReadVector(push, "place_m")});
    }
    entry.RejectUnknownKeys();
  }
  root.RejectUnknownKeys();
  try {
    return Schedule(std::move(payloads), std::move(pushes), std::move(lost_drives),
                    std::move(lost_frictions));
  } catch (const std::invalid_argument& error) {
    root.Fail("disturbances", error.what());
  }
}

Schedule LoadSchedule(const std::filesystem::path& path) {
  return ReadSchedule(Section::Load(path, "sinew-body-disturbance/1"));
}

}  // namespace sinew::body_disturbance
