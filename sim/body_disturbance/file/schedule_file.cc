#include "sim/body_disturbance/file/schedule_file.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace sinew::body_disturbance {

namespace {

using config::Section;

constexpr std::size_t kLongestName = 64;  // of a link, in sim_body_disturbance

std::array<double, 3> ReadVector(const Section& section, std::string_view key) {
  const std::vector<double> values = section.Numbers(key);
  if (values.size() != 3) {
    section.Fail(key, std::to_string(values.size()) + " numbers, expected x, y, z");
  }
  std::array<double, 3> vector{};
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

std::string ReadLink(const Section& section) {
  std::string link = section.Text("link");
  if (link.empty() || link.size() > kLongestName) {
    section.Fail("link", "'" + link + "', expected a name of 1 to 64 characters");
  }
  return link;
}

}  // namespace

Schedule ReadSchedule(const Section& root) {
  std::vector<Payload> payloads;
  std::vector<Push> pushes;
  for (const Section& entry : root.List("disturbances")) {
    Interval when{.at_s = entry.Number("at_s", config::kNotNegative)};
    if (entry.Has("for_s")) when.until_s = when.at_s + entry.Number("for_s", config::kPositive);
    if (!entry.Has("payload") && !entry.Has("push")) {
      entry.Fail("at_s", "nothing acts, expected a payload or a push");
    }
    if (entry.Has("payload")) {
      const Section payload = entry.Child("payload");
      payloads.push_back({.when = when,
                          .link = ReadLink(payload),
                          .mass_kg = payload.Number("mass_kg", config::kPositive),
                          .place_m = ReadVector(payload, "place_m")});
    }
    if (entry.Has("push")) {
      const Section push = entry.Child("push");
      pushes.push_back({.when = when,
                        .link = ReadLink(push),
                        .force_N = ReadVector(push, "force_N"),
                        .place_m = ReadVector(push, "place_m")});
    }
    entry.RejectUnknownKeys();
  }
  root.RejectUnknownKeys();
  try {
    return Schedule(std::move(payloads), std::move(pushes));
  } catch (const std::invalid_argument& error) {
    root.Fail("disturbances", error.what());
  }
}

Schedule LoadSchedule(const std::filesystem::path& path) {
  return ReadSchedule(Section::Load(path, "sinew-body-disturbance/1"));
}

}  // namespace sinew::body_disturbance
