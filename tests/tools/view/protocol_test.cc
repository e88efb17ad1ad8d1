// The Foxglove WebSocket protocol as texts and bytes.
#include "tools/view/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tools/view/subscriptions.h"

namespace sinew::live {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ViewProtocol, ServerInfoOffersNothingThatCommands) {
  const Json info = Json::parse(ServerInfoText("view, domain 3", "abc"));
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["name"], "view, domain 3");
  EXPECT_EQ(info["capabilities"], Json::array());
  EXPECT_EQ(info["sessionId"], "abc");
}

TEST(ViewProtocol, ChannelsAreAdvertisedAsTheRecordingsHaveThem) {
  const Json message = Json::parse(AdvertiseText(
      {{ChannelNumber{7}, "imu", "sinew::msg::Imu", "module sinew { /* \"x\"\n */ };"}}));
  EXPECT_EQ(message["op"], "advertise");
  const Json& channel = message["channels"].at(0);
  EXPECT_EQ(channel["id"], 7);
  EXPECT_EQ(channel["topic"], "imu");
  EXPECT_EQ(channel["encoding"], "cdr");
  EXPECT_EQ(channel["schemaName"], "sinew::msg::Imu");
  EXPECT_EQ(channel["schemaEncoding"], "omgidl");
  EXPECT_EQ(channel["schema"], "module sinew { /* \"x\"\n */ };");
}

TEST(ViewProtocol, AMessageBeginsWithOpcodeSubscriptionAndStampLittleEndian) {
  const DataHead head = MessageDataHead(SubscriptionNumber{0x01020304}, 0x1112131415161718);
  const std::array<unsigned, 13> expected = {1,    0x04, 0x03, 0x02, 0x01, 0x18, 0x17,
                                             0x16, 0x15, 0x14, 0x13, 0x12, 0x11};
  for (std::size_t i = 0; i < head.size(); ++i) {
    EXPECT_EQ(std::to_integer<unsigned>(head[i]), expected[i]) << i;
  }
  EXPECT_EQ(MessageDataHead(SubscriptionNumber{1}, -5)[5], std::byte{0});
}

TEST(ViewProtocol, SubscriptionsAreRead) {
  const ClientMessage message = ParseClientText(
      R"({"op": "subscribe", "subscriptions": [{"id": 0, "channelId": 3}, {"id": 4294967295, "channelId": 1}]})");
  const auto* subscribe = std::get_if<Subscribe>(&message);
  ASSERT_NE(subscribe, nullptr);
  ASSERT_EQ(subscribe->items.size(), 2u);
  EXPECT_EQ(subscribe->items[0].channel, ChannelNumber{3});
  EXPECT_EQ(subscribe->items[1].subscription, SubscriptionNumber{4294967295});
  const ClientMessage other =
      ParseClientText(R"({"op": "unsubscribe", "subscriptionIds": [5, 6]})");
  const auto* unsubscribe = std::get_if<Unsubscribe>(&other);
  ASSERT_NE(unsubscribe, nullptr);
  EXPECT_THAT(unsubscribe->subscriptions,
              ElementsAre(SubscriptionNumber{5}, SubscriptionNumber{6}));
}

TEST(ViewProtocol, WhatIsWrongIsNamed) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "not a JSON object"},
      {"[1]", "not a JSON object"},
      {"{\"op\": 3}", "no text 'op'"},
      {R"({"op": "advertise", "channels": []})", "'advertise' is not offered"},
      {R"({"op": "subscribe"})", "no array 'subscriptions'"},
      {R"({"op": "subscribe", "subscriptions": [7]})", "subscribe: 7"},
      {R"({"op": "subscribe", "subscriptions": [{"id": 1}]})", "expected {id, channelId}"},
      {R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]})", "-1"},
      {R"({"op": "subscribe", "subscriptions": [{"id": 4294967296, "channelId": 1}]})",
       "4294967296"},
      {R"({"op": "unsubscribe", "subscriptionIds": ["a"]})", "\"a\""},
  };
  for (const auto& [text, expected] : cases) {
    const ClientMessage message = ParseClientText(text);
    const auto* refused = std::get_if<Refused>(&message);
    ASSERT_NE(refused, nullptr) << text;
    EXPECT_THAT(refused->why, HasSubstr(expected)) << text;
  }
}

TEST(ViewProtocol, AnyBytesOfAClientAreReadWithoutHarm) {
  std::mt19937 random(1);
  const std::string valid = R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]})";
  for (int i = 0; i < 20000; ++i) {
    std::string text = valid.substr(0, random() % (valid.size() + 1));
    for (unsigned changes = random() % 4; changes > 0 && !text.empty(); --changes) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    const ClientMessage message = ParseClientText(text);
    if (const auto* refused = std::get_if<Refused>(&message)) {
      EXPECT_TRUE(Json::accept(StatusText(StatusLevel::kError, refused->why)));
    }
  }
}

TEST(ViewProtocol, ATextThatIsNestedDeeplyIsReadWithoutHarm) {
  const std::string list = R"({"op": "subscribe", "subscriptions": )";
  const ClientMessage message =
      ParseClientText(list + std::string(100000, '[') + std::string(100000, ']') + "}");
  ASSERT_TRUE(std::holds_alternative<Refused>(message));
  EXPECT_LT(std::get<Refused>(message).why.size(), 200u);
}

TEST(ViewProtocol, TheSubprotocolIsOneOfAList) {
  EXPECT_EQ(ChooseSubprotocol("foxglove.websocket.v1"), kSubprotocol);
  EXPECT_EQ(ChooseSubprotocol("foxglove.sdk.v1"), kSdkSubprotocol);
  EXPECT_EQ(ChooseSubprotocol("foxglove.sdk.v1, foxglove.websocket.v1"), kSdkSubprotocol);
  EXPECT_EQ(ChooseSubprotocol("foxglove.websocket.v1,x"), kSubprotocol);
  EXPECT_EQ(ChooseSubprotocol("sinew.batch.v1, foxglove.websocket.v1"), kBatchSubprotocol);
  EXPECT_EQ(ChooseSubprotocol("foxglove.websocket.v1, sinew.batch.v1"), kSubprotocol);
  EXPECT_EQ(ChooseSubprotocol(""), "");
  EXPECT_EQ(ChooseSubprotocol("foxglove.websocket.v12"), "");
}

TEST(ViewProtocol, ABatchIsFramesWithTheirLengths) {
  std::vector<std::byte> batch;
  const std::array<std::byte, 2> payload = {std::byte{0xaa}, std::byte{0xbb}};
  AppendToBatch(MessageDataHead(SubscriptionNumber{7}, 1), payload, &batch);
  AppendToBatch(MessageDataHead(SubscriptionNumber{8}, 2), {}, &batch);
  const std::vector<unsigned> expected = {15, 0, 0, 0, 1, 7,    0,    0,  0, 1, 0, 0,
                                          0,  0, 0, 0, 0, 0xaa, 0xbb, 13, 0, 0, 0, 1,
                                          8,  0, 0, 0, 2, 0,    0,    0,  0, 0, 0, 0};
  ASSERT_EQ(batch.size(), expected.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    EXPECT_EQ(std::to_integer<unsigned>(batch[i]), expected[i]) << i;
  }
}

TEST(ViewSubscriptions, AChannelGoesToAllWhoAskedUntilTheyLeave) {
  Subscriptions subscriptions(2);
  EXPECT_THAT(subscriptions.Add({{{SubscriptionNumber{5}, ChannelNumber{2}},
                                  {SubscriptionNumber{6}, ChannelNumber{2}}}}),
              IsEmpty());
  EXPECT_THAT(subscriptions.Of(ChannelNumber{1}), IsEmpty());
  EXPECT_THAT(subscriptions.Of(ChannelNumber{2}),
              ElementsAre(SubscriptionNumber{5}, SubscriptionNumber{6}));
  EXPECT_THAT(subscriptions.Remove({{SubscriptionNumber{5}}}), IsEmpty());
  EXPECT_THAT(subscriptions.Of(ChannelNumber{2}), ElementsAre(SubscriptionNumber{6}));
}

TEST(ViewSubscriptions, AClientHasAFewForEachChannel) {
  Subscriptions subscriptions(2);
  Subscribe many;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    many.items.push_back({SubscriptionNumber{i}, ChannelNumber{1}});
  }
  const std::vector<std::string> problems = subscriptions.Add(many);
  EXPECT_EQ(subscriptions.size(), subscriptions.most());
  ASSERT_EQ(problems.size(), 1000 - subscriptions.most());
  EXPECT_THAT(problems[0], HasSubstr("8 is one too many, expected 8 at most"));
}

TEST(ViewSubscriptions, WhatIsWrongIsReportedAndTheRestCounts) {
  Subscriptions subscriptions(2);
  EXPECT_THAT(subscriptions.Add({{{SubscriptionNumber{1}, ChannelNumber{0}},
                                  {SubscriptionNumber{2}, ChannelNumber{3}},
                                  {SubscriptionNumber{3}, ChannelNumber{1}},
                                  {SubscriptionNumber{3}, ChannelNumber{2}}}}),
              ElementsAre(HasSubstr("no channel 0, expected 1 to 2"), HasSubstr("no channel 3"),
                          HasSubstr("subscription 3 is there already")));
  EXPECT_EQ(subscriptions.size(), 1u);
  EXPECT_THAT(subscriptions.Remove({{SubscriptionNumber{9}, SubscriptionNumber{3}}}),
              ElementsAre(HasSubstr("no subscription 9")));
  EXPECT_EQ(subscriptions.size(), 0u);
}

}  // namespace
}  // namespace sinew::live
