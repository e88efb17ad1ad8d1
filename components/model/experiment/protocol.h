// An experiment as a generator of commands: what to command in this cycle, given the sensors.
//
// It is independent of topics, clocks and the provider: the surrogate in process, a state provider
// behind DDS, or a robot. A hand that pushes the link is part of a protocol; where there is a
// person, `instruction()` is the command to the person and the load cell measures the result.
//
// Angles at the output (0 = horizontal, positive up) unless a name says motor; motor torque at the
// motor shaft, positive drives up; forces at the end of the link, positive presses down; gauge
// pressures. Times count from the start of the experiment. One owner. Step allocates nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "components/base/types/control_mode.h"

namespace sinew::experiment {

// Sensor values; also a row of a recording.
struct Reading {
  double time_s = 0.0;
  double motor_angle_rad = 0.0;  // motor shaft
  double motor_velocity_rad_s = 0.0;
  double output_angle_rad = 0.0;
  double output_velocity_rad_s = 0.0;
  double motor_current_A = 0.0;
  double chamber_pressure_bar = 0.0;
  double reservoir_pressure_bar = 0.0;
  double load_force_N = 0.0;
  bool valve_open = false;
};
using Row = Reading;
using Recording = std::vector<Row>;

struct Command {
  types::ControlMode drive = types::ControlMode::kIdle;
  double motor_torque_Nm = 0.0;
  double position_rad = 0.0;  // output
  bool valve_open = true;
  bool compressor_on = false;
  bool vent_open = false;
  double hand_force_N = 0.0;
};

// Beginning of an experiment. A simulation may be put there; elsewhere Preparation gets there.
struct Start {
  double output_angle_rad = 0.0;
  double motor_offset_rad = 0.0;  // motor/N - output angle: 0 is the middle of the play
  double pressure_bar = 0.0;
  double rest_s = 0.0;
  bool rotor_locked = false;     // the rotor is held mechanically, or by position control
  bool motor_uncoupled = false;  // the motor stands on the bench, without gearbox and link
};

class Protocol {
 public:
  virtual ~Protocol() = default;
  virtual Start start() const = 0;
  // reading.time_s counts from the experiment's start.
  virtual Command Step(const Reading& reading) noexcept = 0;
  virtual bool done() const noexcept { return done_; }
  virtual double expected_s() const = 0;        // about; for a progress bar
  virtual std::string instruction() const = 0;  // to the person at the link; empty: none needed

 protected:
  bool done_ = false;
};

// Keeps a pressure by switching: the reservoir is joined to the chamber.
struct PressureKeeper {
  double target_bar = 0.0;
  double band_bar = 0.03;
  void Apply(const Reading& reading, Command* command) const noexcept;
  bool reached(const Reading& reading) const noexcept;
};

// Brings the robot to a protocol's start: pressure, angle (position mode, slowly), rest; then runs
// it. The reading that the protocol sees counts time from its own start.
class Prepared : public Protocol {
 public:
  Prepared(std::unique_ptr<Protocol> protocol, double gear_ratio);
  Start start() const override { return protocol_->start(); }
  Command Step(const Reading& reading) noexcept override;
  bool done() const noexcept override { return protocol_->done(); }
  double expected_s() const override;
  std::string instruction() const override;
  bool ready() const noexcept { return phase_ == Phase::kRun; }
  double started_s() const noexcept { return begin_s_; }  // on the outer clock, once ready

 private:
  enum class Phase { kFirst, kMove, kRest, kRun };
  std::unique_ptr<Protocol> protocol_;
  double gear_ratio_;
  PressureKeeper keeper_;
  Phase phase_ = Phase::kFirst;
  double wanted_rad_ = 0.0;
  double last_s_ = 0.0;
  double begin_s_ = 0.0;
  double rest_from_s_ = 0.0;
};

// A small generator for the unevenness of a person: SplitMix64, the same on every machine.
class Person {
 public:
  explicit Person(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ull + 0x1234567ull) {}
  double Uniform(double lower, double upper) noexcept;

 private:
  std::uint64_t state_;
};

}  // namespace sinew::experiment
