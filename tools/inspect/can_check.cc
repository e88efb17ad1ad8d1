#include "tools/inspect/can_check.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "components/base/types/json_text.h"

namespace sinew::inspect {

namespace {

using CanJson = nlohmann::json;

// A member on a path; null where one is missing.
const CanJson& At(const CanJson& json, std::initializer_list<const char*> path) {
  static const CanJson kNothing;
  const CanJson* at = &json;
  for (const char* key : path) {
    if (!at->is_object() || !at->contains(key)) return kNothing;
    at = &(*at)[key];
  }
  return *at;
}

double NumberOr(const CanJson& json, double fallback) {
  return json.is_number() ? json.get<double>() : fallback;
}

std::string Whole(double value) { return std::to_string(static_cast<long long>(value)); }

Finding CheckInterface(const CanJson& link, const CanSettings& settings) {
  const std::string name = At(link, {"ifname"}).get<std::string>();
  const CanJson& flags = At(link, {"flags"});
  const bool up = std::find(flags.begin(), flags.end(), "UP") != flags.end();
  const CanJson& kind = At(link, {"linkinfo", "info_kind"});
  const CanJson& data = At(link, {"linkinfo", "info_data"});
  const CanJson& counters = At(link, {"linkinfo", "info_xstats"});
  Finding finding{"can", Severity::kOk, name + ": " + (up ? "up" : "down"), ""};
  const auto add = [&finding](Severity severity, const std::string& text,
                              const std::string& advice) {
    finding.text += ", " + text;
    if (severity > finding.severity) {
      finding.severity = severity;
      finding.advice = advice;
    }
  };
  if (kind == "vcan") {
    finding.text += ", virtual";
    if (!up) add(Severity::kWarning, "not started", "ip link set " + name + " up");
    return finding;
  }
  const std::string set_up = "ip link set " + name + " up type can bitrate " +
                             Whole(settings.bitrate_bit_s) + " restart-ms 100";
  if (!up) {
    add(Severity::kFault, "not started", set_up);
    return finding;
  }
  const CanJson& state = At(data, {"state"});
  if (state.is_string()) {
    const std::string text = state.get<std::string>();
    if (text == "BUS-OFF") {
      add(Severity::kFault, text,
          "wiring and bitrate of all nodes; restart-ms 0 never sends again: " + set_up);
    } else if (text == "ERROR-PASSIVE") {
      add(Severity::kFault, text, "no other node answers: wiring, termination (60 ohm), bitrate");
    } else if (text == "ERROR-WARNING") {
      add(Severity::kWarning, text, "errors on the bus: termination (60 ohm), ground, length");
    } else {
      add(text == "ERROR-ACTIVE" ? Severity::kOk : Severity::kWarning, text, set_up);
    }
  }
  const double bitrate = NumberOr(At(data, {"bittiming", "bitrate"}), 0.0);
  if (bitrate != settings.bitrate_bit_s) {
    add(Severity::kFault, Whole(bitrate) + " bit/s, expected " + Whole(settings.bitrate_bit_s),
        set_up);
  } else {
    add(Severity::kOk, Whole(bitrate) + " bit/s", "");
  }
  if (NumberOr(At(data, {"restart_ms"}), 0.0) == 0.0) {
    add(Severity::kWarning, "restart-ms 0: silent for good after bus-off", set_up);
  }
  const double queue = NumberOr(At(link, {"txqlen"}), 0.0);
  if (queue < settings.least_txqueuelen) {
    add(Severity::kWarning, "txqueuelen " + Whole(queue),
        "ip link set " + name + " txqueuelen " + std::to_string(settings.least_txqueuelen) +
            ": setpoints are lost from the fourth joint on");
  }
  for (const char* counter : {"bus_off", "error_passive", "bus_error"}) {
    const double count = NumberOr(At(counters, {counter}), 0.0);
    if (count > 0.0) {
      add(Severity::kWarning, std::string(counter) + " " + Whole(count) + " since it was set up",
          "errors in the past: candump -e " + name);
    }
  }
  return finding;
}

}  // namespace

std::vector<Finding> CheckCan(const std::string& ip_json, const CanSettings& settings) {
  CanJson links;
  try {
    links = types::ParseJson<CanJson>(ip_json, "");
  } catch (const std::invalid_argument&) {  // no list
  }
  if (!links.is_array()) throw std::invalid_argument("ip printed no list in JSON");
  std::vector<Finding> findings;
  for (const CanJson& link : links) {
    if (At(link, {"link_type"}) == "can" && At(link, {"ifname"}).is_string()) {
      findings.push_back(CheckInterface(link, settings));
    }
  }
  if (findings.empty()) {
    findings.push_back({"can", Severity::kNote, "no CAN interface", ""});
  }
  return findings;
}

std::vector<std::string> WireGuardIn(const std::string& ip_json) {
  std::vector<std::string> names;
  for (const CanJson& link : CanJson::parse(ip_json, nullptr, false)) {
    if (At(link, {"linkinfo", "info_kind"}) != "wireguard") continue;
    if (const CanJson& name = At(link, {"ifname"}); name.is_string()) names.push_back(name);
  }
  return names;
}

}  // namespace sinew::inspect
