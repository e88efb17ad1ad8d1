// What a datagram has to be before Fast DDS may read it: RTPS 2.x (OMG formal/2022-04-01, 9.4),
// well formed to the last length. Fast DDS 2.9 ends the process on a submessage of its own
// statistics that is not the last one, and on a sample of the writer 0 for a reader of an EXCLUSIVE
// topic; it reads beyond lists of partitions, and makes as many representations as a number says.
// What is checked is therefore every length and every count that it reads without a check.
//
//   dropped as a whole: no RTPS header, a length that leaves the datagram, a submessage that
//     contradicts itself (sets of sequence numbers, fragments, lists of parameters), a sample of a
//     writer without an identifier, fragments of discovery
//   taken out, the rest goes on: submessages of vendors (0x80 and above, statistics included) and
//     those of no use here; parameters of discovery that no participant needs
//
// It knows no keys: who sends well-formed RTPS is accepted, as by every participant without DDS
// security (docs/safety.md). Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sinew::node::internal {

class DatagramFilter {
 public:
  // secure: the participant has DDS security, whose submessages and tokens are handed on.
  explicit DatagramFilter(bool secure) : secure_(secure) {}

  // What may be read of it: a part of the datagram itself, or of `copy` when something in its
  // middle had to be taken out. Empty: nothing.
  std::span<const std::uint8_t> Pass(std::span<const std::uint8_t> datagram,
                                     std::vector<std::uint8_t>* copy) const;

 private:
  bool secure_;
};

}  // namespace sinew::node::internal
