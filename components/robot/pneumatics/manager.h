// Holds the pressure of one pneumatic element by three relays, and goes to a safe state when it
// cannot.
//
// Rig: the compressor fills the reservoir, the valve joins chamber and reservoir, the vent (the
// controlled leak) lets air out of the reservoir. kReservoir keeps the valve open while it holds,
// so that the reservoir's volume smooths what the motion does. kChamber shuts it between
// corrections (the source's experiment inside the backlash); the chamber is so small that it takes
// the reservoir's pressure at once, so a correction brings the reservoir to the target first (where
// it has a sensor), lets it come to rest and then opens the valve. It stays open, and corrections
// go on as in kReservoir, until none was needed for calm_s: air that was just pumped is warm, and
// would cool in a shut chamber.
//
// A correction starts when the filtered pressure is start_band_bar off its target, and ends when
// the pressure expected lead_s later (dead time of relays, filter) has reached it. Between a
// filling and a venting lies settle_s, and each relay keeps its least times: no hunting.
//
// Faults, latched until Reset:
//
//     sensor        not a number or outside its range for sensor_time_s
//     overpressure  above max_pressure_bar for sensor_time_s
//     no response   response_s of filling or venting moved the pressure less than response_bar
//     valve         its contact (where there is one) disagrees for feedback_time_s
//     leak          at rest the pressure falls faster than leak_limit_bar_s, averaged over
//                   leak_window_s and for half as long
//     rises         the same upward: the compressor or the valve is stuck on
//
// The safe state: compressor off at once; vent_when_safe decides between valve and vent open (air
// goes out) and both shut. Lost samples are no fault: all relays off until there are samples again.
//
// Gauge pressure, bar. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <sinew_idl/pneumatics.h>

#include "components/robot/pneumatics/relay.h"
#include "components/robot/pneumatics/stiffness_table.h"

namespace sinew::pneumatics {

enum class HoldWith { kReservoir, kChamber };
using Mode = msg::PneumaticMode;
enum class Fault { kNone, kSensor, kOverpressure, kNoResponse, kValve, kLeak, kRises };
const char* FaultText(Fault fault) noexcept;

struct ManagerConfig {
  HoldWith hold_with = HoldWith::kReservoir;
  double target_bar = 0.0;        // until something else is asked for
  double max_target_bar = 6.0;    // asked for more: this
  double band_bar = 0.05;         // settled inside it
  double start_band_bar = 0.035;  // a correction starts outside it
  double lead_s = 0.12;
  double settle_s = 1.0;
  double calm_s = 3.0;  // kChamber: before the valve shuts
  double filter_Hz = 5.0;
  RelayTimes valve{0.2, 0.2};
  RelayTimes compressor{0.2, 0.5};
  RelayTimes vent{0.1, 0.2};
  bool reservoir_sensor = false;
  bool valve_feedback = false;
  bool vent_when_safe = true;
  bool vent_when_idle = false;  // not active: let the air out
  StiffnessTable stiffness;

  double sensor_lower_bar = -0.2;
  double sensor_upper_bar = 10.0;
  double sensor_time_s = 0.05;
  double max_pressure_bar = 7.0;
  double response_s = 4.0;
  double response_bar = 0.05;
  double feedback_time_s = 0.2;
  double leak_limit_bar_s = 0.03;
  double leak_window_s = 10.0;
};

struct ManagerInput {
  double period_s = 0.0;
  bool active = false;  // may hold pressure: armed, or always by configuration
  bool valid = false;   // the samples are of this tick
  double chamber_bar = 0.0;
  double reservoir_bar = 0.0;
  bool valve_is_open = false;
  bool reset = false;  // the operator's word after a fault
  // Another manager switches the relays, and this one stands by: it filters and checks the sensors,
  // takes the relays as they are, and checks neither them nor what the pressure does.
  bool standby = false;
};

struct ManagerOutput {
  Mode mode = Mode::kIdle;
  Fault fault = Fault::kNone;
  bool valve_open = false;
  bool compressor_on = false;
  bool vent_open = false;
  double target_bar = 0.0;
  double pressure_bar = 0.0;  // filtered
  double stiffness_Nm_rad = 0.0;
  bool settled = false;
  bool sensor_fault = false;
};

class PressureManager {
 public:
  // Throws std::invalid_argument with the value that is wrong.
  explicit PressureManager(const ManagerConfig& config);

  // Asks for a pressure; drawn into 0 to max_target_bar. Not finite: refused, false.
  bool RequestPressure(double pressure_bar) noexcept;
  // Asks for a stiffness; false when the table has no such stiffness. The old target stays.
  bool RequestStiffness(double stiffness_Nm_rad) noexcept;

  ManagerOutput Step(const ManagerInput& input) noexcept;

  // Forgets faults and filters: a new session.
  void Restart() noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  double target_bar() const noexcept { return target_bar_; }
  // Fall of pressure at rest, averaged; 0 until there is enough of it.
  double leak_bar_s() const noexcept;
  long switches() const noexcept {
    return valve_.switches() + compressor_.switches() + vent_.switches();
  }

 private:
  struct Filtered {
    double value_bar = 0.0;
    double rate_bar_s = 0.0;
    // Moves toward a sample; returns by how much.
    double Step(double sample_bar, double share, double period_s) noexcept;
    void Exchange(types::StateArchive& archive);
  };

  void Watch(const ManagerInput& input) noexcept;
  // Progress of a correction of a shut chamber.
  enum class Stage { kDirect, kPrepare, kComeToRest, kEqualise };

  // The pressure on which compressor and vent act.
  const Filtered& Moved() const noexcept;
  void Correct(double period_s) noexcept;
  void StartCorrection() noexcept;
  ManagerOutput Drive(double period_s) noexcept;
  ManagerOutput AllOff(Mode mode, bool let_out) noexcept;

  ManagerConfig config_;
  Relay valve_, compressor_, vent_;
  double target_bar_;

  Fault fault_ = Fault::kNone;
  Mode mode_ = Mode::kIdle;
  bool known_ = false;
  bool uses_reservoir_ = false;
  Filtered chamber_;
  Filtered reservoir_;
  Stage stage_ = Stage::kDirect;
  double stage_s_ = 0.0;
  bool joined_ = false;  // the valve of kChamber stays open after a correction
  double bad_sensor_s_ = 0.0;
  double bad_reservoir_s_ = 0.0;
  double overpressure_s_ = 0.0;
  double feedback_s_ = 0.0;
  double still_s_ = 0.0;          // since the last correction
  double correcting_s_ = 0.0;     // of the present correction, since progress was last seen
  double progress_bar_ = 0.0;     // pressure when it was
  double rest_change_bar_ = 0.0;  // forgotten sums of pressure change and time at rest
  double rest_time_s_ = 0.0;
  double leaking_s_ = 0.0;  // the leak has been above its limit for so long
};

}  // namespace sinew::pneumatics
