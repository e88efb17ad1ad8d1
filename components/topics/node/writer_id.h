// Identity of a DDS writer: its GUID as 16 bytes, participant first.
#pragma once

#include <array>
#include <cstdint>

namespace sinew::node {

using WriterId = std::array<std::uint8_t, 16>;

}  // namespace sinew::node
