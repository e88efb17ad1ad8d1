// Differences of the outputs of a rerun from the recorded ones, field by field, as numbers.
//
// A list that is longer than a joint array (a reservoir, a readout) is one field, "feature[]".
// Times are ticks of the outputs. Thread: one; allocates.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/record/recording/idl_schema.h"

namespace sinew::rerun {

struct FieldSummary {
  std::string topic, field;
  std::uint64_t ticks = 0;  // in which it differs
  std::uint64_t first_tick = 0;
  double rms = 0.0;  // of now - recorded, over those; in the field's unit, enumerators by number
  double largest = 0.0;  // by magnitude, with its sign
  std::uint64_t largest_tick = 0;
};

class Differences {
 public:
  // Payloads of one message, canonical. One that cannot be decoded adds nothing.
  void Add(const std::string& topic, std::uint64_t tick, const recording::IdlType& type,
           std::span<const std::byte> recorded, std::span<const std::byte> rerun);
  // By topic, in the order of the message's fields.
  std::vector<FieldSummary> Summaries() const;

 private:
  struct Sum {
    FieldSummary summary;
    std::uint64_t values = 0, last_tick = 0;
    double squares = 0.0;
    std::size_t order = 0;  // of the field in its message
  };
  std::map<std::pair<std::string, std::string>, Sum> sums_;
};

}  // namespace sinew::rerun
