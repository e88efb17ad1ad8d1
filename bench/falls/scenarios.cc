#include "bench/falls/scenarios.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "bench/rigs/drawn/random.h"

namespace sinew::falls {

namespace {

using body_disturbance::Push;
using rigs::Random;

// The detector needs 2 s of standing; the shipped references move from 3.5 s on.
constexpr double kBegin_s = 3.6;
constexpr double kFallEnds_s = 3.5;  // after the disturbance: what stands then has not fallen
constexpr double kLatest_s = 7.5;    // of a fall's disturbance: the first squat has ended
constexpr double kBenchmark_s = 14.5, kSix_s = 34.5;  // references' soft start, squats, soft stop

constexpr std::uint64_t kFallStream = 1, kSquatStream = 2;

std::array<double, 3> Horizontal(double force_N, double direction_rad) {
  return {force_N * std::cos(direction_rad), force_N * std::sin(direction_rad), 0.0};
}

Push PushOf(double at_s, double for_s, double force_N, double direction_rad) {
  return {.when = {at_s, at_s + for_s},
          .link = "torso",
          .force_N = Horizontal(force_N, direction_rad),
          .place_m = {0.0, 0.0, 0.0715}};  // the middle of the torso's frame (shapes.csv)
}

template <class... Values>
std::string Text(const char* format, Values... values) {
  std::array<char, 128> text{};
  const int size = std::snprintf(text.data(), text.size(), format, values...);
  return {text.data(), static_cast<std::size_t>(size)};
}

double Direction(Random* random) { return random->Uniform(-std::numbers::pi, std::numbers::pi); }

double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

}  // namespace

std::string_view KindName(Kind kind) noexcept {
  constexpr std::array<std::string_view, kFallKinds + kSquatKinds> kNames = {
      "push", "lost drive", "slip", "benchmark", "six", "payload", "nudge"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view ControllerName(Controller controller) noexcept {
  constexpr std::array<std::string_view, kControllers> kNames = {"position", "pid",
                                                                 "computed torque"};
  return kNames[static_cast<std::size_t>(controller)];
}

Scenario DrawFall(std::uint64_t seed, int number) {
  Random random(seed + static_cast<std::uint64_t>(number), kFallStream);
  Scenario scenario;
  scenario.seed = seed + static_cast<std::uint64_t>(number);
  scenario.kind = static_cast<Kind>(number % kFallKinds);
  scenario.controller = static_cast<Controller>(number / kFallKinds % kControllers);
  const double at_s = scenario.acts_at_s = random.Uniform(kBegin_s, kLatest_s);
  scenario.duration_s = at_s + kFallEnds_s;
  const double direction_rad = Direction(&random);
  if (scenario.kind == Kind::kPush) {
    const double force_N = random.Uniform(80.0, 250.0), for_s = random.Uniform(0.1, 0.4);
    scenario.schedule = {{}, {PushOf(at_s, for_s, force_N, direction_rad)}};
    scenario.text = Text("%.0f N for %.2f s towards %.0f deg at %.2f s", force_N, for_s,
                         Degrees(direction_rad), at_s);
  } else if (scenario.kind == Kind::kLostDrive) {
    constexpr std::array kJoints = {"knee", "hip_pitch", "ankle_pitch", "ankle_roll"};
    const std::string side = random.Chance(0.5) ? "left_" : "right_";
    const std::string joint =
        side + kJoints[static_cast<std::size_t>(random.Integer(0, int{kJoints.size()} - 1))];
    scenario.schedule = {{}, {}, {{.when = {at_s, body_disturbance::kForEver_s}, .joint = joint}}};
    scenario.text = Text("%s at %.2f s", joint.c_str(), at_s);
  } else {
    constexpr double kNudge_s = 0.3;
    const double lost = random.Uniform(0.85, 1.0), force_N = random.Uniform(20.0, 60.0);
    scenario.schedule = {{},
                         {PushOf(at_s, kNudge_s, force_N, direction_rad)},
                         {},
                         {{.when = {at_s, body_disturbance::kForEver_s}, .share = lost}}};
    scenario.text = Text("%.0f %% of the friction lost, %.0f N towards %.0f deg at %.2f s",
                         100.0 * lost, force_N, Degrees(direction_rad), at_s);
  }
  return scenario;
}

Scenario DrawSquats(std::uint64_t seed, int number) {
  Random random(seed + static_cast<std::uint64_t>(number), kSquatStream);
  Scenario scenario;
  scenario.seed = seed + static_cast<std::uint64_t>(number);
  scenario.kind = static_cast<Kind>(kFallKinds + number % kSquatKinds);
  scenario.controller = static_cast<Controller>(number / kSquatKinds % kControllers);
  scenario.duration_s = scenario.kind == Kind::kSix ? kSix_s : kBenchmark_s;
  if (scenario.kind == Kind::kPayload) {
    const double at_s = scenario.acts_at_s = random.Uniform(kBegin_s, 10.0);
    const double mass_kg = random.Uniform(0.5, 4.0);
    scenario.schedule = {{{.when = {at_s, body_disturbance::kForEver_s},
                           .link = "torso",
                           .mass_kg = mass_kg,
                           .place_m = {0.0, 0.0, 0.0715}}},
                         {}};
    scenario.text = Text("%.1f kg at %.2f s", mass_kg, at_s);
  } else if (scenario.kind == Kind::kNudge) {
    std::vector<Push> pushes;
    for (const double from_s : {kBegin_s, 7.0, 10.5}) {
      const double at_s = from_s + random.Uniform(0.0, 2.0);
      const double force_N = random.Uniform(5.0, 20.0), for_s = random.Uniform(0.1, 0.3);
      pushes.push_back(PushOf(at_s, for_s, force_N, Direction(&random)));
      scenario.text += Text("%s%.0f N", scenario.text.empty() ? "" : ", ", force_N);
    }
    scenario.acts_at_s = pushes.front().when.at_s;
    scenario.schedule = {{}, pushes};
  }
  return scenario;
}

}  // namespace sinew::falls
