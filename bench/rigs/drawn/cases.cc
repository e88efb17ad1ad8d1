#include "bench/rigs/drawn/cases.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/rigs/drawn/random.h"
#include "bench/rigs/drawn/sizing.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {

using types::kPi;

std::string NameOf(const Rig& rig, const Case& c, std::size_t index) {
  std::string number = std::to_string(rig.number);
  number.insert(0, number.size() < 6 ? 6 - number.size() : 0, '0');
  std::string out = number + "-" + std::to_string(index) + "-" + WordOf(c.kind);
  if (c.share > 0.0) out += c.share > 0.2 ? "-strong" : "-weak";
  out += std::string("-") + WordOf(c.excitation);
  if (!c.fault.empty()) out += "-" + c.fault;
  return out;
}

}  // namespace

const char* WordOf(CaseKind kind) {
  switch (kind) {
    case CaseKind::kPlain:
      return "plain";
    case CaseKind::kEffect:
      return "effect";
    case CaseKind::kPair:
      return "pair";
    case CaseKind::kOutside:
      return "outside";
    case CaseKind::kIgnorance:
      return "ignorance";
    case CaseKind::kFault:
      return "fault";
    case CaseKind::kHidden:
      return "hidden";
    case CaseKind::kPlanted:
      return "planted";
  }
  return "";
}

const char* RecordingName(int recording) {
  static const char* const kNames[] = {"train_1", "train_2", "train_3", "sealed"};
  return kNames[recording];
}

const std::vector<std::vector<std::string>>& SameByDefinition() {
  static const std::vector<std::vector<std::string>> kSame = {
      // One constant while the joint moves.
      {"direction_dependent_coulomb", "current_offset", "offset"},
      // One column up to a declared efficiency.
      {"load_dependent_friction", "drive_efficiency_direction"},
      // Elasticity behind a single encoder, cut off at another order.
      {"elastic_joint", "gear_compliance"},
  };
  return kSame;
}

std::vector<Case> DrawCases(const Rig& rig) {
  Random random(rig.number, 3000);
  std::vector<Case> cases;
  auto pick = [&random](std::vector<std::string>& from) {
    const auto at = static_cast<std::size_t>(random.Integer(0, static_cast<int>(from.size()) - 1));
    std::string name = from[at];
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(at));
    return name;
  };
  // Not every effect can be as large as asked in every rig: three in drawn order.
  auto three = [&pick](std::vector<std::string>& from) {
    std::vector<std::string> out;
    while (out.size() < 3 && !from.empty()) out.push_back(pick(from));
    return out;
  };
  auto add = [&](Case c) {
    c.name = NameOf(rig, c, cases.size());
    cases.push_back(c);
  };
  const std::vector<std::string> all = EffectsOf(rig, Kind::kCatalogue);
  std::vector<std::string> catalogue = all, weak = all, task = all;
  std::vector<std::string> outside = EffectsOf(rig, Kind::kOutside);
  std::vector<std::string> ignorance = EffectsOf(rig, Kind::kIgnorance);
  using enum CaseKind;
  using enum Excitation;
  add({"", kPlain, kDesigned, 0.0, {}, ""});
  add({"", kEffect, kDesigned, kStrongShare, three(catalogue), ""});
  add({"", kEffect, kDesigned, kWeakShare, three(weak), ""});
  const bool second = rig.number >= kSecondDraw;
  const bool plain_task = random.Chance(0.3) || second;
  if (plain_task) add({"", kPlain, kTask, 0.0, {}, ""});
  if (!plain_task || second) {
    add({"", kEffect, kTask, random.Chance(0.7) ? kStrongShare : kWeakShare, three(task), ""});
  }
  if (random.Chance(0.5)) {
    add({"", kOutside, kDesigned, kStrongShare, three(outside), ""});
  } else {
    // Two that show in the torque and are no shift of a declared parameter.
    std::vector<std::string> left;
    for (const std::string& name : all) {
      const EffectInfo& info = FindEffect(name);
      if (info.shows == Shows::kTorque && !info.absorbed) left.push_back(name);
    }
    const std::string one = pick(left), two = pick(left);
    add({"", kPair, kDesigned, kStrongShare, {one, two}, ""});
  }
  if (random.Chance(0.5)) {
    add({"", kIgnorance, kDesigned, kStrongShare, three(ignorance), ""});
  } else {
    std::vector<std::string> faults = FaultsOf(rig);
    add({"", kFault, kDesigned, 0.0, {}, pick(faults)});
  }
  if (rig.family == Family::kSeaPea && random.Chance(0.6)) {
    if (random.Chance(0.4)) {
      add({"", kPlain, kLocked, 0.0, {}, ""});
    } else {
      std::vector<std::string> locked = {"presliding", "pressure_dependent_friction",
                                         "seal_hysteresis", "pressure_offset"};
      add({"", kEffect, kLocked, kStrongShare, three(locked), ""});
    }
  }
  if (second) {
    std::vector<std::string> left = all, tried;
    while (!left.empty()) tried.push_back(pick(left));
    add({"", kHidden, kTask, kStrongShare, tried, ""});
  }
  return cases;
}

std::vector<std::string> FaultsOf(const Rig& rig) {
  std::vector<std::string> faults = {"spikes", "frozen_encoder", "stuck_drive"};
  if (rig.drive != Drive::kWinding) faults.push_back("reversed_drive");
  if (!rig.linear) faults.push_back("degrees_as_radians");
  if (rig.motor_encoder && rig.gear_ratio > 2.0) faults.push_back("wrapped_motor_angle");
  if (rig.drive == Drive::kCurrent && rig.gear_ratio > 2.0) faults.push_back("missing_gear_ratio");
  return faults;
}

std::vector<FaultRows> PlantFault(const Rig& rig, const std::string& fault,
                                  std::vector<std::vector<Reading>>& recordings) {
  Random random(rig.number, 4000);
  std::vector<FaultRows> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    std::vector<Reading>& rows = recordings[i];
    const int n = static_cast<int>(rows.size());
    const std::string name = RecordingName(static_cast<int>(i));
    if (fault == "reversed_drive") {
      for (Reading& r : rows) r.drive = -r.drive;
      out.push_back({name, 0, n - 1});
    } else if (fault == "degrees_as_radians") {
      for (Reading& r : rows) {
        r.position *= 180.0 / kPi;
        r.velocity *= 180.0 / kPi;
      }
      out.push_back({name, 0, n - 1});
    } else if (fault == "spikes") {
      for (int k = 0; k < std::max(3, n / 1500); ++k) {
        const int at = random.Integer(0, n - 1);
        rows[static_cast<std::size_t>(at)].position +=
            random.Sign() * rig.amplitude * random.Uniform(0.5, 3.0);
        out.push_back({name, at, at});
      }
    } else if (fault == "frozen_encoder" || fault == "stuck_drive") {
      if (i != 1) continue;  // one recording
      const int first = random.Integer(n / 5, n / 2), last = first + n / 5;
      const Reading held = rows[static_cast<std::size_t>(first)];
      for (int k = first; k <= last; ++k) {
        Reading& r = rows[static_cast<std::size_t>(k)];
        if (fault == "stuck_drive") {
          r.drive = held.drive;
        } else {
          r.position = held.position;
          r.velocity = 0.0;
          if (!rig.output_encoder && rig.motor_encoder) {
            r.motor_rad = held.motor_rad;
            r.motor_velocity_rad_s = 0.0;
          }
        }
      }
      out.push_back({name, first, last});
    } else if (fault == "wrapped_motor_angle") {
      for (Reading& r : rows) r.motor_rad = std::remainder(r.motor_rad, 2.0 * kPi);
      out.push_back({name, 0, n - 1});
    } else if (fault != "missing_gear_ratio") {
      throw std::invalid_argument("no fault is called " + fault);
    }
  }
  return out;
}

}  // namespace sinew::rigs
