// The fields that are an object's state, once for both ways (types/state_archive.h).
#include "components/base/types/state_archive.h"
#include "components/robot/reference/standby.h"

namespace sinew::reference {

void Point::Exchange(types::StateArchive& archive) {
  archive(position_rad, velocity_rad_s, acceleration_rad_s2);
}

// A move is made while the robot runs: what it was made from is part of it.
void Move::Exchange(types::StateArchive& archive) {
  archive(config_.from_rad, config_.to_rad, config_.speed_rad_s, config_.acceleration_rad_s2, sign_,
          speed_rad_s_, ramp_s_, cruise_s_);
}

void Generator::Exchange(types::StateArchive& archive) {
  archive(start_rad_, soft_start_s_, carried_, carry_s_);
}

void RobotReferenceOutput::Exchange(types::StateArchive& archive) {
  archive.Bounded(joint_count, types::kMaxJoints);
  archive(idle, stale, finished, joint);
}

void RobotReference::Exchange(types::StateArchive& archive) {
  archive(joints_, moving_, asked_, running_, holding_, held_, session_id_, allowed_tick_,
          start_tick_);
}

void Standby::Exchange(types::StateArchive& archive) {
  archive(own_, owner_, owner_tick_, follows_);
}

}  // namespace sinew::reference
