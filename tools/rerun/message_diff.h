// Two payloads of one type compared: the first differing byte, and the field it belongs to.
//
// Payloads are CDR with their 4-byte header, canonical (recording/cdr.h). Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/record/recording/cdr.h"

namespace sinew::rerun {

struct FieldDifference {
  std::string field;  // "motor_torque_Nm[0]"; "(payload)" where one of the two is no such message
  std::size_t byte = 0;         // the first one that differs, from the start of the payload
  std::string recorded, rerun;  // values of the field; of a payload: its byte in hexadecimal
};

// Nothing: the same bytes.
std::optional<FieldDifference> FirstDifference(const recording::IdlType& type,
                                               std::span<const std::byte> recorded,
                                               std::span<const std::byte> rerun);

// A value of a message. The count of a sequence is a leaf of its own, "feature.count".
struct Leaf {
  std::string field;
  std::string text;
  double number = 0.0;     // of texts 0
  bool is_number = false;  // integers, booleans and reals
};
// In order. Throws recording::CdrError.
std::vector<Leaf> LeavesOf(const recording::IdlType& type, std::span<const std::byte> payload);

}  // namespace sinew::rerun
