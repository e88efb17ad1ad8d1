#include "tools/rerun/output_facts.h"

#include <array>
#include <string_view>

#include "tools/rerun/stage.h"

namespace sinew::rerun {
namespace {

struct TickName {
  std::string_view field, topic;
};
// The fields of components/topics/node/tick_loop.cc, SetInputTick.
constexpr std::array<TickName, 8> kTickNames = {{{"actuator_tick", "actuator_state"},
                                                 {"reference_tick", "reference"},
                                                 {"regime_tick", "regime"},
                                                 {"prediction_tick", "torque_prediction"},
                                                 {"readout_tick", "readout"},
                                                 {"motion_tick", "motion_request"},
                                                 {"reservoir_tick", "reservoir_state"},
                                                 {"command_tick", "joint_command"}}};

std::string EventField(std::uint32_t i) { return "event_ids[" + std::to_string(i) + "]"; }

}  // namespace

OutputFacts::OutputFacts(const std::string& topic) : topic_(topic) {
  const recording::IdlType& type = TypeOf(topic);
  for (const TickName& name : kTickNames) {
    if (recording::HasField(type, name.field)) {
      ticks_.emplace_back(name.topic, recording::CdrField(type, name.field));
    }
  }
  if (recording::HasField(type, "joining")) joining_.emplace(type, "joining");
  if (recording::HasField(type, "previous_tick")) previous_.emplace(type, "previous_tick");
  for (std::uint32_t i = 0; recording::HasField(type, EventField(i)); ++i) {
    events_.emplace_back(type, EventField(i));
  }
}

void OutputFacts::AddTo(std::span<const std::byte> payload, UsedInputs* used) const {
  used->any_output = true;
  try {
    for (const auto& [input, field] : ticks_) {
      used->tick[input] = static_cast<std::uint64_t>(field.AsInt(payload));
    }
    if (previous_) used->previous_cycle = static_cast<std::uint64_t>(previous_->AsInt(payload));
    if (joining_) used->joining = joining_->AsInt(payload) != 0;
    for (const recording::CdrField& id : events_) {
      used->events.insert(static_cast<std::uint64_t>(id.AsInt(payload)));
    }
  } catch (const recording::CdrError&) {
    // The list of events ends, or the payload does: the comparison reports that.
  }
}

}  // namespace sinew::rerun
