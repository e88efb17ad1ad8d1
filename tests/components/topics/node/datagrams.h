// RTPS datagrams made by hand, little endian unless a test says otherwise.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

namespace sinew::node::testing {

using Datagram = std::vector<std::uint8_t>;

inline void AddNumber(Datagram* to, std::uint64_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) to->push_back(static_cast<std::uint8_t>(value >> 8 * k));
}
inline void Add(Datagram* to, std::span<const std::uint8_t> bytes) {
  to->insert(to->end(), bytes.begin(), bytes.end());
}
inline void AddText(Datagram* to, std::string_view text) {
  AddNumber(to, text.size() + 1, 4);
  for (const char c : text) to->push_back(static_cast<std::uint8_t>(c));
  to->push_back(0);
  while (to->size() % 4 != 0) to->push_back(0);
}
// Upper word first.
inline void AddSequenceNumber(Datagram* to, std::uint64_t value) {
  AddNumber(to, value >> 32, 4);
  AddNumber(to, value & 0xffffffff, 4);
}

// Header: "RTPS", 2.2, a vendor (Fast DDS by default), a prefix.
inline Datagram Header(std::initializer_list<std::uint8_t> vendor = {1, 15}) {
  Datagram out = {'R', 'T', 'P', 'S', 2, 2};
  Add(&out, vendor);
  for (std::uint8_t k = 0; k < 12; ++k) out.push_back(static_cast<std::uint8_t>(0xa0 + k));
  return out;
}
inline void AddSubmessage(Datagram* to, std::uint8_t id, const Datagram& body,
                          std::uint8_t flags = 1) {
  to->push_back(id);
  to->push_back(flags);
  AddNumber(to, body.size(), 2);
  Add(to, body);
}
inline Datagram Parameter(std::uint16_t id, const Datagram& value) {
  Datagram out;
  AddNumber(&out, id, 2);
  AddNumber(&out, value.size(), 2);
  Add(&out, value);
  return out;
}

inline constexpr std::uint8_t kDataId = 0x15, kFragmentId = 0x16, kStatisticsId = 0x80;

// DATA with a payload; writer: as its bytes stand on the wire, the last one its kind.
inline Datagram Data(std::initializer_list<std::uint8_t> writer, const Datagram& payload,
                     std::uint64_t number = 1) {
  Datagram out;
  AddNumber(&out, 0, 2);
  AddNumber(&out, 16, 2);
  AddNumber(&out, 0, 4);
  Add(&out, writer);
  AddSequenceNumber(&out, number);
  Add(&out, payload);
  return out;
}
inline constexpr std::uint8_t kWithPayload = 1 | 4;

// A participant's lease of whole seconds.
inline Datagram Lease(std::uint32_t seconds) {
  Datagram value;
  AddNumber(&value, seconds, 4);
  AddNumber(&value, 0, 4);  // fraction
  return Parameter(2, value);
}

// What announces a participant: its list of parameters, by default with a lease at the end.
inline Datagram Announcement(std::initializer_list<Datagram> parameters,
                             const Datagram& lease = Lease(3)) {
  Datagram list = {0, 3, 0, 0};
  for (const Datagram& parameter : parameters) Add(&list, parameter);
  Add(&list, lease);
  Add(&list, Parameter(1, {}));
  return Data({0, 1, 0, 0xc2}, list);
}

}  // namespace sinew::node::testing
