// The harnesses: bytes in, properties checked, a Violation thrown when one does not hold. libFuzzer
// drives them (libfuzzer_entry.cc), and so does a test with seeds and fixed mutations
// (fuzz_test.cc).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sinew::fuzz {

using Input = std::vector<std::uint8_t>;

struct Harness {
  const char* name;
  void (*run)(std::span<const std::uint8_t> input);
  std::vector<Input> (*seeds)();
};

// Frames of controllers, sensor nodes and gateways: what decodes encodes to the same; every wrong
// length is refused; a frame's time on the bus stays below the worst case.
void RunCodec(std::span<const std::uint8_t> input);
std::vector<Input> CodecSeeds();

// Lines of candump -l: what is taken is of the format, and comes back from its own text.
void RunCandump(std::span<const std::uint8_t> input);
std::vector<Input> CandumpSeeds();

// Frames into the bridge: whatever comes, what leaves is what the commands allow (plant_watch.h).
void RunPlant(std::span<const std::uint8_t> input);
std::vector<Input> PlantSeeds();
// The same with the joints of one bus behind a gateway.
void RunGatewayPlant(std::span<const std::uint8_t> input);

// Frames into the virtual axes: an axis is moved only by frames of its own number.
void RunAxes(std::span<const std::uint8_t> input);
std::vector<Input> AxesSeeds();

// Offers to the bus model: what is delivered was offered, once, in order, and nothing overlaps.
void RunBusModel(std::span<const std::uint8_t> input);
std::vector<Input> BusModelSeeds();

// Packets into the server of the virtual bus: only possible frames reach others, who stay served.
void RunBusServer(std::span<const std::uint8_t> input);
std::vector<Input> BusServerSeeds();

inline constexpr Harness kHarnesses[] = {
    {"codec", RunCodec, CodecSeeds},
    {"candump", RunCandump, CandumpSeeds},
    {"plant", RunPlant, PlantSeeds},
    {"axes", RunAxes, AxesSeeds},
    {"gateway", RunGatewayPlant, PlantSeeds},
    {"bus_model", RunBusModel, BusModelSeeds},
    {"bus_server", RunBusServer, BusServerSeeds},
};

}  // namespace sinew::fuzz
