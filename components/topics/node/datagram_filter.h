// The form of a datagram that Fast DDS may read: RTPS 2.x (OMG formal/2022-04-01, 9.4), well formed
// to the last length. Fast DDS 2.9 ends the process on a submessage of its own statistics that is
// not the last one, and on a sample of the writer 0 for a reader of an EXCLUSIVE topic; it reads
// beyond lists of partitions, and makes as many representations as a number says. What is checked
// is therefore every length and every count that it reads without a check.
//
//   dropped as a whole: no RTPS header, a length that leaves the datagram, a submessage that
//     contradicts itself (sets of sequence numbers, fragments, lists of parameters), a sample of a
//     writer without an identifier, fragments of discovery
//   taken out, the rest goes on: submessages of vendors (0x80 and above, statistics included) and
//     those of no use here; parameters of discovery that no participant needs; plain submessages
//     where DDS security protects all
//
// It knows no keys: well-formed RTPS of any sender is accepted, as by every participant without DDS
// security (docs/safety.md). Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sinew::node::internal {

// DDS security of the participant. Fast DDS 2.9 decrypts what is encrypted, and reads what is not
// as well: a plain sample in the name of a participant with keys reaches its readers unless the
// payload itself is protected.
enum class Protection {
  kNone,      // without: its submessages and tokens are taken out
  kAllowed,   // handed on, and plain ones as well
  kRequired,  // plain ones are taken out, but for announcements and handshakes, which have no keys
              // yet
};

class DatagramFilter {
 public:
  explicit DatagramFilter(Protection protection) : protection_(protection) {}

  // The part that may be read: of the datagram itself, or of `copy` when something in its middle
  // had to be taken out. Empty: nothing.
  std::span<const std::uint8_t> Pass(std::span<const std::uint8_t> datagram,
                                     std::vector<std::uint8_t>* copy) const;

 private:
  Protection protection_;
};

}  // namespace sinew::node::internal
