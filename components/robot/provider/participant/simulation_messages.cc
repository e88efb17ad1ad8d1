#include "components/robot/provider/participant/simulation_messages.h"

#include <algorithm>

namespace sinew::provider {

msg::SimTruth ToMessage(const msg::Header& header, int joint_count, const GearTruth& truth) {
  msg::SimTruth message;
  message.header = header;
  message.joint_count = static_cast<std::uint8_t>(joint_count);
  for (std::size_t j = 0; j < truth.contact.size(); ++j) {
    const int side = truth.contact[j];
    message.contact[j] = side > 0   ? msg::ContactSide::kUpper
                         : side < 0 ? msg::ContactSide::kLower
                                    : msg::ContactSide::kNone;
  }
  message.play_angle_rad = truth.play_angle_rad;
  message.backlash_rad = truth.backlash_rad;
  return message;
}

msg::SimBodyTruth ToMessage(const msg::Header& header, const BodyTruth& truth) {
  msg::SimBodyTruth message;
  message.header = header;
  message.position_m = truth.position_m;
  message.orientation_wxyz = truth.orientation_wxyz;
  message.velocity_m_s = truth.velocity_m_s;
  message.angular_velocity_rad_s = truth.angular_velocity_rad_s;
  auto to = message.contact_force_N.begin();
  for (const auto& force_N : truth.contact_force_N) {
    to = std::copy(force_N.begin(), force_N.end(), to);
  }
  return message;
}

BodyDisturbance FromMessage(const msg::SimBodyDisturbance& message) {
  return {.payload_link = message.payload_link,
          .payload_kg = message.payload_kg,
          .payload_m = message.payload_m,
          .push_link = message.push_link,
          .push_force_N = message.push_force_N,
          .push_m = message.push_m,
          .lost_drive = message.lost_drive,
          .lost_friction = message.lost_friction};
}

}  // namespace sinew::provider
