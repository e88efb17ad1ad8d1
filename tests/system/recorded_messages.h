// The messages of a recording, decoded.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "components/topics/node/codec.h"
#include "tests/system/recording_payloads.h"

namespace sinew::testing {

// Of one topic, in the order of the file. Throws std::out_of_range for a topic that is not there; a
// payload that cannot be decoded fails the test.
template <class Message>
std::vector<Message> MessagesOf(const std::map<std::string, std::vector<std::string>>& recording,
                                const std::string& topic) {
  std::vector<Message> messages;
  for (const std::string& payload : recording.at(topic)) {
    node::Bytes bytes(payload.size());
    std::memcpy(bytes.data(), payload.data(), payload.size());
    EXPECT_TRUE(node::Decode(bytes, &messages.emplace_back())) << topic;
  }
  return messages;
}

}  // namespace sinew::testing
