// Whether every estop that a robot requires is alive and none of its inputs is held or lost.
// Pure: time and what was heard come in. Thread: one.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::estop {

class Watch {
 public:
  // Since the last heartbeat, or since `begin_ns`; six of its periods.
  static constexpr std::int64_t kLost_ns = 300'000'000;

  // required: names of participants.
  Watch(const std::vector<std::string>& required, std::int64_t begin_ns);

  // A heartbeat; of a name that is not required nothing.
  void Hear(std::string_view name, bool stops, std::string_view why, std::int64_t now_ns);

  // "estop 'button' is silent for 312 ms, limit 300 ms: is sinew-estop alive?" or "estop 'button':
  // held: ..."; empty: all is well. Allocates where it is not.
  std::string Problem(std::int64_t now_ns) const;

 private:
  struct Estop {
    std::string name;
    std::int64_t heard_ns = 0;
    std::string stopping;  // empty: no input stops
  };
  std::vector<Estop> estops_;
};

}  // namespace sinew::estop
