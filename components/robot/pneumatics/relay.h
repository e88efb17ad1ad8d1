// A relay that is not switched more often than it may be: least time on and off.
// Thread: one. Allocates nothing.
#pragma once

namespace sinew::types {
class StateArchive;
}

namespace sinew::pneumatics {

struct RelayTimes {
  double min_on_s = 0.0;
  double min_off_s = 0.0;
};

class Relay {
 public:
  // Throws std::invalid_argument for times that are negative or not finite.
  explicit Relay(const RelayTimes& times);

  // Returns the relay's state now, after period_s in its present one.
  bool Step(bool wanted, double period_s) noexcept;
  // Switches at once, whatever the times say: the safe state does not wait.
  void Force(bool on) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  bool on() const noexcept { return on_; }
  long switches() const noexcept { return switches_; }

 private:
  RelayTimes times_;
  bool on_ = false;
  double since_s_;  // in the present state
  long switches_ = 0;
};

}  // namespace sinew::pneumatics
