#include "sim/body_disturbance/file/schedule_file.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace sinew::body_disturbance {

// A link or joint, as sim_body_disturbance carries it.
static void CheckName(const config::Fields& f, std::string_view key, const std::string& name) {
  constexpr std::size_t kLongest = 64;
  if (!f.reads() || (!name.empty() && name.size() <= kLongest)) return;
  f.Fail(key, "'" + name + "', expected a name of 1 to 64 characters");
}

// Keys of a payload or push.
static void DescribePlace(config::Fields& f, std::string& link, std::array<double, 3>& place_m) {
  f.Need("link", link, "of the URDF");
  CheckName(f, "link", link);
  f.Need("place_m", place_m, "in the link's frame");
}

static void DescribeEntry(config::Fields& f, ScheduleParts* parts) {
  Interval when;
  std::optional<double> for_s, friction;
  std::optional<std::string> drive;
  f.Need("at_s", when.at_s, config::kNotNegative, "since the robot was armed first");
  f("for_s", for_s, config::kPositive, "left out: to the end of the session");
  if (for_s) when.until_s = when.at_s + *for_s;
  const bool payload = f.If("payload", "a mass fixed to a link", [&](config::Fields& g) {
    Payload& c = parts->payloads.emplace_back();
    c.when = when;
    DescribePlace(g, c.link, c.place_m);
    g.Need("mass_kg", c.mass_kg, config::kPositive, "of the payload");
  });
  const bool push = f.If("push", "a force on a link", [&](config::Fields& g) {
    Push& c = parts->pushes.emplace_back();
    c.when = when;
    DescribePlace(g, c.link, c.place_m);
    g.Need("force_N", c.force_N, "world axes");
  });
  f("lost_drive", drive, "joint whose drive has no torque");
  f("lost_friction", friction, {0.0, 1.0}, "share of the ground's friction that is missing");
  if (drive) {
    CheckName(f, "lost_drive", *drive);
    parts->lost_drives.push_back({.when = when, .joint = *drive});
  }
  if (friction) parts->lost_frictions.push_back({.when = when, .share = *friction});
  f.Require(payload || push || drive || friction, "at_s",
            "nothing acts, expected payload, push, lost_drive or lost_friction");
}

void Describe(config::Fields& f, ScheduleParts& parts) {
  f.NeedList("disturbances", {}, "one of each kind acts at a time",
             [&](config::Fields& entry) { DescribeEntry(entry, &parts); });
}

Schedule ReadSchedule(const config::Section& root) {
  auto parts = config::Read<ScheduleParts>(root);
  try {
    return Schedule(std::move(parts.payloads), std::move(parts.pushes),
                    std::move(parts.lost_drives), std::move(parts.lost_frictions));
  } catch (const std::invalid_argument& error) {
    root.Fail("disturbances", error.what());
  }
}

Schedule LoadSchedule(const std::filesystem::path& path) {
  return ReadSchedule(config::Section::Load(path, kSchema));
}

}  // namespace sinew::body_disturbance
