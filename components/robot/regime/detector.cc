#include "components/robot/regime/detector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::regime {

const char* TroubleText(Trouble trouble) noexcept {
  switch (trouble) {
    case Trouble::kNone:
      return "none";
    case Trouble::kNoPressure:
      return "setup: the chamber did not reach its pressure in time";
    case Trouble::kNoContact:
      return "setup: the output did not follow the motor";
    case Trouble::kUnsteady:
      return "setup: the play angle scattered too much over the contact";
    case Trouble::kInconsistent:
      return "the play angle is outside the backlash: setup, backlash or an encoder is wrong";
    case Trouble::kBadInput:
      return "a measured angle is not a number";
  }
  return "unknown";
}

RegimeDetector::RegimeDetector(const DetectorConfig& config) : config_(config), play_(config.play) {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) +
                                  ", expected more than 0");
    }
  };
  positive(config.gear_ratio, "gear ratio");
  positive(config.inconsistent_rad, "inconsistency limit");
  if (!std::isfinite(config.play_center_rad))
    throw std::invalid_argument("center of the play is not finite");
  if (config.setup == Setup::kActive) {
    positive(config.setup_pressure_bar, "setup pressure");
    positive(config.min_pressure_bar, "least pressure");
    positive(config.velocity_rad_s, "setup velocity");
    positive(config.motor_torque_limit_Nm, "setup torque limit");
    positive(config.contact_travel_rad, "contact travel");
    positive(config.timeout_s, "setup time-out");
    if (std::abs(config.chamber_direction) != 1.0) {
      throw std::invalid_argument("chamber direction is " +
                                  std::to_string(config.chamber_direction) + ", expected 1 or -1");
    }
    if (config.min_pressure_bar > config.setup_pressure_bar) {
      throw std::invalid_argument("least pressure is above the setup pressure");
    }
    if (!(config.travel_rad > config.play.backlash_rad + config.contact_travel_rad)) {
      throw std::invalid_argument("setup travel is " + std::to_string(config.travel_rad) +
                                  " rad, expected more than backlash and contact travel together");
    }
  }
  Forget();
}

void RegimeDetector::Forget() noexcept {
  play_.Reset();
  trouble_ = Trouble::kNone;
  outside_ = 0;
  stage_ = Stage::kIdle;
  setup_done_ = config_.setup == Setup::kGiven;
  offset_rad_ = config_.play_center_rad - 0.5 * config_.play.backlash_rad;
  offset_error_rad_ = 0.0;
}

void RegimeDetector::Fail(Trouble trouble) noexcept {
  trouble_ = trouble;
  stage_ = Stage::kFailed;
  setup_done_ = false;
}

void RegimeDetector::HandleSetup(const DetectorInput& input, DetectorOutput* output) noexcept {
  const double motor_rad = input.motor_position_rad / config_.gear_ratio;
  const double gap_rad = motor_rad - input.output_position_rad;
  const double push = -config_.chamber_direction;  // the motor turns against the chamber
  if (stage_ == Stage::kIdle) {
    stage_ = Stage::kPressurise;
    stage_s_ = 0.0;
    trouble_ = Trouble::kNone;
  }
  stage_s_ += input.period_s;
  output->phase = Phase::kSetup;
  output->request_pressure_bar = config_.setup_pressure_bar;

  if (stage_ == Stage::kPressurise) {
    output->request = types::Motion::kHold;
    if (input.pressure_bar >= config_.min_pressure_bar) {
      stage_ = Stage::kPush;
      stage_s_ = 0.0;
      start_motor_rad_ = motor_rad;
      target_rad_ = motor_rad + push * config_.travel_rad;
      rigid_count_ = 0;
    } else if (stage_s_ > config_.timeout_s) {
      Fail(Trouble::kNoPressure);
    }
    return;
  }

  output->request = types::Motion::kPushAgainstChamber;
  output->request_target_rad = target_rad_;
  if (input.pressure_bar < config_.min_pressure_bar) {
    Fail(Trouble::kNoPressure);
    return;
  }
  // Rigid as long as the gap stays within noise of where it was; else it begins anew here.
  const double sigma = play_.sigma_rad();
  if (rigid_count_ == 0 ||
      std::abs(gap_rad - rigid_sum_rad_ / rigid_count_ - rigid_first_rad_) > 6.0 * sigma) {
    rigid_motor_rad_ = motor_rad;
    rigid_first_rad_ = gap_rad;
    rigid_sum_rad_ = rigid_squares_rad2_ = 0.0;
    rigid_count_ = 0;
  }
  const double offset = gap_rad - rigid_first_rad_;
  rigid_sum_rad_ += offset;
  rigid_squares_rad2_ += offset * offset;
  ++rigid_count_;
  const double way_rad = push * (motor_rad - rigid_motor_rad_);
  if (way_rad >= config_.contact_travel_rad && rigid_count_ >= 8) {
    const double mean = rigid_sum_rad_ / rigid_count_;
    const double variance = std::max(0.0, rigid_squares_rad2_ / rigid_count_ - mean * mean);
    if (std::sqrt(variance) > 3.0 * sigma) {
      Fail(Trouble::kUnsteady);
      return;
    }
    const double contact_rad = rigid_first_rad_ + mean;
    offset_rad_ =
        config_.chamber_direction > 0.0 ? contact_rad : contact_rad - config_.play.backlash_rad;
    offset_error_rad_ = std::sqrt(std::max(variance, sigma * sigma) / rigid_count_);
    setup_done_ = true;
    stage_ = Stage::kIdle;
    play_.Reset();
    outside_ = 0;
    return;
  }
  if (stage_s_ > config_.timeout_s ||
      push * (motor_rad - start_motor_rad_) >= 0.999 * config_.travel_rad) {
    Fail(Trouble::kNoContact);
  }
}

void RegimeDetector::StartSession(std::uint64_t session_id) noexcept {
  if (session_known_ && session_id == session_id_) return;
  session_known_ = true;
  session_id_ = session_id;
  Forget();
}

void RegimeDetector::Adopt(std::uint64_t session_id, double offset_rad) noexcept {
  if (!std::isfinite(offset_rad)) return;
  StartSession(session_id);
  if (setup_done_) return;
  play_.Reset();
  offset_rad_ = offset_rad;
  offset_error_rad_ = play_.sigma_rad();  // the owner's is not known here: that of one sample
  setup_done_ = true;
  stage_ = Stage::kIdle;
  trouble_ = Trouble::kNone;
  outside_ = 0;
}

DetectorOutput RegimeDetector::Step(const DetectorInput& input) noexcept {
  StartSession(input.session_id);
  if (!input.armed) {
    // A setup that was interrupted or failed may be tried again the next time.
    if (stage_ != Stage::kIdle) stage_ = Stage::kIdle;
  }
  DetectorOutput output;
  output.trouble = trouble_;
  if (!input.valid) return output;
  if (!std::isfinite(input.motor_position_rad) || !std::isfinite(input.output_position_rad) ||
      !std::isfinite(input.output_velocity_rad_s) ||
      (config_.setup == Setup::kActive && !std::isfinite(input.pressure_bar))) {
    output.trouble = Trouble::kBadInput;
    return output;
  }

  if (!setup_done_) {
    if (config_.setup == Setup::kActive && input.armed && stage_ != Stage::kFailed)
      HandleSetup(input, &output);
    output.trouble = trouble_;
    if (stage_ == Stage::kFailed) {
      output.phase = Phase::kWaiting;
      output.request = types::Motion::kNone;
    }
    if (!setup_done_) return output;
    output = DetectorOutput{};
  }

  const double alpha_rad =
      input.motor_position_rad / config_.gear_ratio - input.output_position_rad - offset_rad_;
  output.alpha_rad = alpha_rad;
  const bool outside = alpha_rad < -config_.inconsistent_rad ||
                       alpha_rad > config_.play.backlash_rad + config_.inconsistent_rad;
  outside_ = outside ? outside_ + 1 : 0;
  if (outside_ >= 3) {
    Fail(Trouble::kInconsistent);
    output.trouble = trouble_;
    return output;
  }
  const PlayDecision decision = play_.Step(alpha_rad, input.output_velocity_rad_s);
  output.phase = Phase::kExecution;
  output.regime = decision.regime;
  output.contact = decision.contact;
  output.confidence = decision.confidence;
  if (offset_error_rad_ > 0.0) {
    const double sigma = play_.sigma_rad();
    output.confidence *= sigma / std::hypot(sigma, offset_error_rad_);
  }
  return output;
}

}  // namespace sinew::regime
