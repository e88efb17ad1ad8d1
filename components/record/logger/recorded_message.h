// A message between reception and file. Plain data: any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "components/record/recording/bytes.h"

namespace sinew::logger {

using WriterGuid = std::array<std::uint8_t, 16>;  // of a DDS writer; zeros: not known

// Writer of a sample, and the sample's number, counted from 1 on without gaps; 0: not known.
struct SampleOrigin {
  WriterGuid writer{};
  std::uint64_t sequence = 0;
};

struct RecordedMessage {
  std::size_t topic = 0;
  recording::Bytes payload;       // CDR
  std::int64_t reception_ns = 0;  // epoch
  std::int64_t stamp_ns = 0;      // of its header
  SampleOrigin origin;
  std::uint64_t session_id = 0;  // of its header
  std::uint64_t instance = 0;    // a hash of the topic's key fields; 0 without any
  bool malformed = false;  // it does not fit its type: stamp, session and instance are not known
};

}  // namespace sinew::logger
