#include "bridge/joints/encoder_watch.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/angle.h"

namespace sinew::bridge {

double EncoderWatch::Stillness::TravelOfOther(double angle_now_rad, double other_now_rad) {
  if (!known || angle_now_rad != angle_rad) *this = {true, angle_now_rad, other_now_rad};
  return std::abs(other_now_rad - other_rad);
}

void EncoderWatch::Update(const JointMeasurement& m, std::int64_t now_ns) {
  if (m.estimates_ns == 0) return;
  const double motor_rad = m.motor_position_at_output_rad();
  const double motor_rad_s = m.motor_velocity_rad_s() / joint_->gear_ratio;
  const bool motor_is_new = m.estimates_ns > motor_ns_;
  if (motor_is_new) {
    const double dt_s =
        motor_ns_ == 0 ? 0.0 : 1e-9 * static_cast<double>(m.estimates_ns - motor_ns_);
    const bool same = motor_.known && motor_.angle_rad == motor_rad;
    own_rev_ = same ? own_rev_ + m.estimates.velocity_rev_s * dt_s : 0.0;
    motor_ns_ = m.estimates_ns;
  }
  const double own_rad = types::kTwoPi / joint_->gear_ratio * (std::abs(own_rev_) - kOwn_rev);
  if (!joint_->zero_check || m.output_ns == 0) {
    if (motor_is_new) (void)motor_.TravelOfOther(motor_rad, 0.0);
    motor_still_rad_ = own_rad;
    return;
  }

  const double output_rad = m.position_rad();
  const double step_s =
      now_ns_ == 0 ? 0.0 : 1e-9 * static_cast<double>(std::max<std::int64_t>(now_ns - now_ns_, 0));
  now_ns_ = now_ns;
  fastest_rad_s_ = std::max({std::abs(motor_rad_s), std::abs(m.velocity_rad_s()),
                             fastest_rad_s_ * std::exp(-step_s / kLagForgets_s)});
  const double age_s = 1e-9 * std::abs(static_cast<double>(m.estimates_ns - m.output_ns));
  const double allowed_rad = joint_->zero_check->tolerance_rad + joint_->compliance_rad +
                             fastest_rad_s_ * (kEncoderLag_s + age_s);
  const double still_rad = joint_->zero_check->play_rad + allowed_rad;
  if (motor_is_new) {
    motor_still_rad_ = std::max(own_rad, motor_.TravelOfOther(motor_rad, output_rad) - still_rad);
  }
  if (m.output_ns > output_ns_) {
    output_still_rad_ = output_.TravelOfOther(output_rad, motor_rad) - still_rad;
    output_ns_ = m.output_ns;
  }
  UpdateSlip(motor_rad, output_rad, allowed_rad, step_s);
}

void EncoderWatch::UpdateSlip(double motor_rad, double output_rad, double allowed_rad,
                              double step_s) {
  const double difference_rad = motor_rad - output_rad;
  slip_rad_ = std::abs(difference_rad) - 0.5 * joint_->zero_check->play_rad - allowed_rad;
  if (slip_rad_ <= 0.0 || slip_s_ == 0.0) {
    slip_motor_rad_ = motor_rad;
    slip_difference_rad_ = difference_rad;
  }
  slip_s_ = slip_rad_ > 0.0 ? slip_s_ + step_s : 0.0;
  const double travel_rad = std::abs(motor_rad - slip_motor_rad_);
  grows_ = std::abs(difference_rad - slip_difference_rad_) >
           std::max(kGrows * travel_rad, joint_->zero_check->tolerance_rad);
}

}  // namespace sinew::bridge
