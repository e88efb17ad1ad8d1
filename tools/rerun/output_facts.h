// Inputs from which a recorded output was computed, by its own words: ticks of inputs, ids of
// events (idl/header.idl), and whether its writer stood by in its first second. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/record/recording/cdr.h"

namespace sinew::rerun {

struct UsedInputs {
  bool any_output = false;
  std::map<std::string, std::uint64_t> tick;  // by input topic; node::kNoTick: none was there
  std::set<std::uint64_t> events;
  bool joining = false;
  std::optional<std::uint64_t> previous_cycle;  // node::kNoTick: this is the first
};

class OutputFacts {
 public:
  // Throws std::invalid_argument: no such topic.
  explicit OutputFacts(const std::string& topic);

  const std::string& topic() const { return topic_; }
  // A payload that is no such message adds nothing.
  void AddTo(std::span<const std::byte> payload, UsedInputs* used) const;

 private:
  std::string topic_;
  std::vector<std::pair<std::string, recording::CdrField>> ticks_;
  std::optional<recording::CdrField> joining_, previous_;
  std::vector<recording::CdrField> events_;  // event_ids[0], event_ids[1] ...
};

}  // namespace sinew::rerun
