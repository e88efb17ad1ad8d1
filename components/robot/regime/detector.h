// Regime of one joint: setup phase and execution phase of Fig 7.1.
//
// Setup finds where on the encoders a contact is. kGiven: the middle of the play is known
// (motor angle / N - output angle = play_center_rad there), as in simulation. kActive, in every
// session anew, once armed: the chamber is pressurised, then the motor turns slowly against it
// until output and motor move together rigidly; the mean of motor / N - output over that motion is
// the contact, and its standard error enters the confidence. A chamber that pushes up gives the
// lower contact, one that pushes down the upper. Without pressure, in too little way or time, it
// gives up: the regime stays unknown until the robot is armed again.
//
// Execution: PlayDetector. When alpha leaves [0, backlash] by more than inconsistent_rad for three
// samples (an encoder slipped, a wrong backlash or setup) the regime is unknown and the setup must
// be repeated.
//
// Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <cstdint>

#include "components/base/types/motion.h"
#include "components/base/types/regime.h"
#include "components/robot/regime/play_detector.h"

namespace sinew::regime {

using Phase = msg::RegimePhase;
enum class Setup { kGiven, kActive };

// Why there is no regime.
enum class Trouble {
  kNone,
  kNoPressure,    // the chamber did not reach its pressure in time
  kNoContact,     // the output did not follow the motor within travel or time
  kUnsteady,      // contact found, but the play angle scattered too much over it
  kInconsistent,  // alpha is where it cannot be: setup, backlash or an encoder is wrong
  kBadInput,      // not a number
};
const char* TroubleText(Trouble trouble) noexcept;

struct DetectorConfig {
  PlayConfig play;
  double gear_ratio = 1.0;
  double inconsistent_rad = 0.01;
  Setup setup = Setup::kGiven;
  double play_center_rad = 0.0;  // kGiven
  // kActive
  double chamber_direction = 1.0;   // +1: pressure pushes the output up
  double setup_pressure_bar = 4.0;  // asked for
  double min_pressure_bar = 3.0;    // contact counts only above it
  double velocity_rad_s = 0.05;     // of the motor at the output
  double motor_torque_limit_Nm = 0.1;
  double travel_rad = 0.2;           // at most, from where the motor stood
  double contact_travel_rad = 0.01;  // rigid motion that proves contact
  double timeout_s = 20.0;
};

struct DetectorInput {
  std::uint64_t session_id = 0;
  double period_s = 0.0;
  bool armed = false;
  bool valid = false;
  double motor_position_rad = 0.0;  // motor shaft
  double output_position_rad = 0.0;
  double output_velocity_rad_s = 0.0;
  double pressure_bar = 0.0;
};

struct DetectorOutput {
  Phase phase = Phase::kWaiting;
  types::Regime regime = types::Regime::kUnknown;
  Contact contact = Contact::kNone;
  double alpha_rad = 0.0;
  double confidence = 0.0;
  Trouble trouble = Trouble::kNone;
  // The setup's request to control and pneumatics: none, to hold or to push.
  types::Motion request = types::Motion::kNone;
  double request_target_rad = 0.0;
  double request_pressure_bar = 0.0;
};

class RegimeDetector {
 public:
  // Throws std::invalid_argument with the value that is wrong.
  explicit RegimeDetector(const DetectorConfig& config);

  // Takes over, in a standby, the contact that another detector has found. One of the same
  // session_id counts here until an own setup. Nothing where there is one already.
  void Adopt(std::uint64_t session_id, double offset_rad) noexcept;

  DetectorOutput Step(const DetectorInput& input) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  bool setup_done() const noexcept { return setup_done_; }
  // motor / N - output at the lower contact, and its standard error; after the setup.
  double offset_rad() const noexcept { return offset_rad_; }
  double offset_error_rad() const noexcept { return offset_error_rad_; }
  const DetectorConfig& config() const noexcept { return config_; }

 private:
  void StartSession(std::uint64_t session_id) noexcept;
  enum class Stage { kIdle, kPressurise, kPush, kFailed };

  void Forget() noexcept;
  void HandleSetup(const DetectorInput& input, DetectorOutput* output) noexcept;
  void Fail(Trouble trouble) noexcept;

  DetectorConfig config_;
  PlayDetector play_;
  std::uint64_t session_id_ = 0;
  bool session_known_ = false;
  bool setup_done_ = false;
  double offset_rad_ = 0.0;
  double offset_error_rad_ = 0.0;
  Trouble trouble_ = Trouble::kNone;
  int outside_ = 0;

  Stage stage_ = Stage::kIdle;
  double stage_s_ = 0.0;
  double start_motor_rad_ = 0.0;  // at the output
  double target_rad_ = 0.0;
  // Rigid motion so far: where it began, and the play angle over it.
  double rigid_motor_rad_ = 0.0;
  double rigid_first_rad_ = 0.0;
  double rigid_sum_rad_ = 0.0;
  double rigid_squares_rad2_ = 0.0;
  int rigid_count_ = 0;
};

}  // namespace sinew::regime
