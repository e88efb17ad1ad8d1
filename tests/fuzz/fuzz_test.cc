// The fuzz harnesses as a test of bounded length: every seed, every seed cut short, and mutations
// from a fixed seed. libFuzzer drives the same functions for as long as one likes (README.md).
// SINEW_FUZZ_RUNS=1000000 makes a long run of it.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/harness.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/property.h"

namespace sinew::fuzz {
namespace {

std::string Hex(const Input& input) {
  std::string text;
  char byte[3];
  for (const std::uint8_t b : input) {
    std::snprintf(byte, sizeof byte, "%02x", b);
    text += byte;
  }
  return text;
}

// False when a property does not hold, with the input in the message.
bool Holds(const Harness& harness, const Input& input) {
  try {
    harness.run(input);
    return true;
  } catch (const std::exception& error) {
    ADD_FAILURE() << harness.name << ": " << error.what() << "\ninput: " << Hex(input);
    return false;
  }
}

void Drive(const char* name, long runs, std::size_t most_bytes) {
  const char* text = std::getenv("SINEW_FUZZ_RUNS");
  if (text != nullptr) runs = std::atol(text);
  for (const Harness& harness : kHarnesses) {
    if (std::string(harness.name) != name) continue;
    const std::vector<Input> seeds = harness.seeds();
    ASSERT_FALSE(seeds.empty());
    ASSERT_TRUE(Holds(harness, {}));
    for (const Input& seed : seeds) ASSERT_TRUE(Holds(harness, seed));
    const Input& longest =
        *std::max_element(seeds.begin(), seeds.end(),
                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    for (std::size_t size = 0; size < std::min<std::size_t>(longest.size(), 64); ++size) {
      ASSERT_TRUE(
          Holds(harness, Input(longest.begin(), longest.begin() + static_cast<long>(size))));
    }
    std::mt19937_64 random(20240817);
    for (long i = 0; i < runs; ++i) {
      ASSERT_TRUE(Holds(harness, Mutate(seeds, most_bytes, random))) << "mutation " << i;
    }
    return;
  }
  FAIL() << "no harness " << name;
}

TEST(Fuzz, WhatTheCodecDecodesItEncodesAgainAndWrongLengthsAreRefused) {
  Drive("codec", 100'000, 256);
}

TEST(Fuzz, LinesOfCandumpComeBackFromTheirText) { Drive("candump", 50'000, 64); }

TEST(Fuzz, NoFramesMakeTheBridgeMoveAJointBeyondItsCommand) { Drive("plant", 3'000, 512); }

TEST(Fuzz, NoFramesMakeTheBridgeMoveAJointBehindAGatewayBeyondItsCommand) {
  Drive("gateway", 3'000, 512);
}

TEST(Fuzz, NoFramesMoveAVirtualAxisThatTheyDoNotName) { Drive("axes", 3'000, 512); }

TEST(Fuzz, TheBusModelDeliversWhatWasOfferedOnceAndInOrder) { Drive("bus_model", 5'000, 512); }

TEST(Fuzz, PacketsOfAHostileClientReachNobodyElse) { Drive("bus_server", 100, 512); }

}  // namespace
}  // namespace sinew::fuzz
