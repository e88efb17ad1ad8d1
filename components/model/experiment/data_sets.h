// The two data sets for networks (5.1.2, 5.1.3), recorded the published way.
//
// Inside the backlash (SEA): motor held, link level, 6 bar falling evenly; a hand pushes the link
// down about twice a second for 100 s. The set ends where the chamber no longer brings the link
// back (Fig 5.5). Outside (PEA): link upright, constant motor torque; a hand presses the link down
// to hanging and eases off, so that the motor brings it back, 100 times (Fig 5.10).
#pragma once

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

struct SeaPlan {
  double duration_s = 100.0;
  double first_bar = 6.0;
  double rate_Hz = 2.0;  // of the pushes
  double force_N = 11.0;
  std::uint64_t seed = 1;  // of the person's unevenness
};

class SeaProtocol : public Protocol {
 public:
  explicit SeaProtocol(const SeaPlan& plan);
  Start start() const override {
    return {.pressure_bar = plan_.first_bar, .rest_s = 1.0, .rotor_locked = true};
  }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return plan_.duration_s; }
  std::string instruction() const override {
    return "push the end of the link down twice a second, and let go";
  }

 private:
  SeaPlan plan_;
  Person person_;
  double stroke_s_ = 1.0;
  double length_s_ = 0.5;
  double size_N_ = 11.0;
};

struct PeaPlan {
  int cycles = 100;
  double cycle_s = 3.5;
  double motor_torque_Nm = 0.02;
  double pressure_bar = 4.0;
  double hand_N_rad = 150.0;
  double largest_hand_N = 60.0;
  std::uint64_t seed = 1;
};

class PeaProtocol : public Protocol {
 public:
  explicit PeaProtocol(const PeaPlan& plan);
  Start start() const override {
    return {
        .output_angle_rad = 1.5707963267948966, .pressure_bar = plan_.pressure_bar, .rest_s = 1.0};
  }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return plan_.cycles * plan_.cycle_s; }
  std::string instruction() const override {
    return "press the link from upright to hanging, then ease off until it is up again";
  }

 private:
  PeaPlan plan_;
  Person person_;
  int cycle_ = 0;
  double start_s_ = 1.0;
  double length_s_ = 3.5;
  double size_rad_ = 3.1;
};

// The rows of the set: up to where the link no longer came back.
Recording TrimSea(const Recording& rows);
Result DescribeSea(const Recording& rows, const RigConstants& rig);
Result DescribePea(const Recording& rows, const RigConstants& rig);

}  // namespace sinew::experiment
