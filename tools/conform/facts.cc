#include "tools/conform/facts.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "components/base/types/joints.h"
#include "components/topics/node/all_messages.h"
#include "components/topics/node/topics.h"

namespace sinew::conform {

namespace {

constexpr std::uint8_t kImpossibleCount = 255;  // the arrays have types::kMaxJoints entries

using Values = types::JointArray<double>;

bool AllFinite(int joint_count, std::initializer_list<const Values*> arrays) {
  return std::all_of(arrays.begin(), arrays.end(), [joint_count](const Values* values) {
    return std::all_of(values->begin(), values->begin() + joint_count,
                       [](double value) { return std::isfinite(value); });
  });
}

template <class Message>
bool IsFinite(const Message&) {
  return true;
}
bool IsFinite(const msg::JointCommand& m) {
  return AllFinite(m.joint_count, {&m.motor_torque_Nm, &m.position_rad, &m.velocity_rad_s});
}
bool IsFinite(const msg::Reference& m) {
  return AllFinite(m.joint_count, {&m.position_rad, &m.velocity_rad_s, &m.acceleration_rad_s2});
}
bool IsFinite(const msg::TorquePrediction& m) {
  return AllFinite(m.joint_count, {&m.torque_Nm, &m.sea_torque_Nm, &m.pea_torque_Nm});
}

bool Drives(const msg::JointCommand& m) {
  for (std::size_t j = 0; j < m.joint_count; ++j) {
    if (m.mode[j] == msg::CommandMode::kIdle) continue;
    if (m.mode[j] != msg::CommandMode::kTorque || m.motor_torque_Nm[j] != 0.0) return true;
  }
  return false;
}

bool IsUnsettled(const msg::PneumaticState& m) {
  return std::none_of(m.settled.begin(), m.settled.begin() + m.joint_count,
                      [](bool settled) { return settled; });
}

template <class Message>
std::optional<Facts> FactsOf(const node::Bytes& payload) {
  Message message;
  if (!node::Decode(payload, &message)) return std::nullopt;
  Facts facts;
  facts.session_id = message.header.session_id;
  facts.tick = message.header.tick;
  facts.origin = message.header.origin;
  if constexpr (requires { message.joint_count; }) facts.joint_count = message.joint_count;
  if constexpr (requires { message.stale; }) facts.stale = message.stale;
  if constexpr (std::is_same_v<Message, msg::PneumaticState>) facts.stale = IsUnsettled(message);
  if constexpr (std::is_same_v<Message, msg::JointCommand>) facts.drives = Drives(message);
  if constexpr (std::is_same_v<Message, msg::ValveCommand>) {
    facts.valve_open = message.valve_open[0];
  }
  facts.finite = IsFinite(message);
  if (!node::Encode(message, &facts.canonical)) return std::nullopt;
  return facts;
}

template <class Message>
node::Bytes ImpossibleCount(const node::Bytes& payload) {
  node::Bytes bytes;
  if constexpr (requires(Message m) { m.joint_count; }) {
    Message message;
    if (!node::Decode(payload, &message)) return bytes;
    message.joint_count = kImpossibleCount;
    if (!node::Encode(message, &bytes)) bytes.clear();
  }
  return bytes;
}

// Calls the function with the topic's constant; false: no such topic.
template <class Function>
bool WithTopic(std::string_view name, Function function) {
#define SINEW_VISIT(topic)        \
  if (name == node::topic.name) { \
    function(node::topic);        \
    return true;                  \
  }
  SINEW_FOR_EACH_TOPIC(SINEW_VISIT)
#undef SINEW_VISIT
  return false;
}

}  // namespace

std::optional<Facts> ReadFacts(std::string_view topic, const node::Bytes& payload) {
  std::optional<Facts> facts;
  WithTopic(topic,
            [&]<class Message>(const node::Topic<Message>&) { facts = FactsOf<Message>(payload); });
  return facts;
}

node::Bytes WithImpossibleCount(std::string_view topic, const node::Bytes& payload) {
  node::Bytes bytes;
  WithTopic(topic, [&]<class Message>(const node::Topic<Message>&) {
    bytes = ImpossibleCount<Message>(payload);
  });
  return bytes;
}

}  // namespace sinew::conform
