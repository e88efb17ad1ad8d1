// Random SIGKILL, SIGSTOP and SIGCONT to the processes of a rig that moves, for a time; who watches
// the bus says whether each state was a defined one.
#pragma once

#include <sinew_idl/operator.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "bench/signals/bus_watch.h"
#include "bench/signals/deployment.h"
#include "bench/signals/growth.h"
#include "components/topics/node/node.h"

namespace sinew::signals {

struct Wanted {
  int domain = 179;
  double seconds = 3600.0;
  int signals = 1000;  // in that time; 0: who is obeyed must not change
  unsigned seed = 1;
  bool realtime = true;
};

struct Outcome {
  int kills = 0, stops = 0, continues = 0, launches = 0;
  int switches = 0;  // between who is obeyed, from command_source
  int stuck = 0;     // not moving again within a minute, so stopped in order and launched anew
  double moving_s = 0.0, seconds = 0.0;
  Findings bus;
  std::vector<std::string> violations;  // beyond the bus'
  std::map<std::string, int> signals;   // by the name of who got them
  std::map<std::string, Grown> grown;
  SharedMemory before, after;
};

class Soak {
 public:
  explicit Soak(const Wanted& wanted);
  Outcome Run();

 private:
  using Clock = std::chrono::steady_clock;
  struct Stopped {
    Clock::time_point until;
    Target target;
  };

  void Take();  // what came over DDS
  void NoteDriver(const std::string& name);
  void Operate();
  void SendSignals();
  void Continue(bool all);
  void KeepLaunched();
  void Launch();
  void Log(const std::string& what) const;
  void Note(const std::string& what);  // a violation

  Wanted wanted_;
  std::mt19937 random_;
  Outcome outcome_;
  std::mutex mutex_;
  std::vector<node::RawSample> samples_;  // outlive node_'s threads
  node::Node node_;
  node::Writer<msg::OperatorCommand> operator_;
  Deployment deployment_;
  Published published_;
  BusWatch bus_;
  Growth growth_;
  msg::JointState state_;
  std::string driver_;  // of this launch
  const Clock::time_point began_ = Clock::now();
  Clock::time_point next_signal_, next_word_, launched_, moved_, sampled_;
  std::vector<Stopped> stopped_;
  std::vector<Target> known_;  // who lived when last looked
};

}  // namespace sinew::signals
