// The server on sockets: a client that does not read loses its oldest messages and delays nobody.
#include "tools/view/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "components/base/config/config.h"
#include "tests/tools/view/socket_client.h"

namespace sinew::live {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

ServerOptions SmallServer() {
  ServerOptions options;
  options.name = "test";
  options.session = "1";
  options.token = "0123456789abcdef";
  options.queue_bytes = 1u << 20;
  return options;
}

HttpReply Echo(const HttpRequest& request) {
  return {200, "text/plain", request.method + " " + request.path + " " + request.query};
}

TEST(ViewServer, ASlowClientLosesItsOldestMessagesAndIsSentHowMany) {
  Server server(SmallServer(), {{ChannelNumber{1}, "a", "A", "struct A {};"}}, Echo);
  Connection slow(server.port());
  ASSERT_TRUE(slow.connected());
  slow.Upgrade(server.port());
  slow.SendText(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":1}]})");
  ASSERT_TRUE(WaitUntil([&] {
    const auto clients = server.clients();
    return clients.size() == 1 && clients[0].subscriptions == 1;
  }));
  // More than its queue and the buffers of both sockets hold, by far.
  constexpr std::uint32_t kMessages = 2000;
  constexpr std::size_t kSize = 16u << 10;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    std::vector<std::byte> payload(kSize);
    for (std::size_t k = 0; k < 4; ++k) payload[k] = static_cast<std::byte>(i >> (8 * k));
    server.Publish(ChannelNumber{1}, i, std::move(payload));
  }
  const ClientCounts counts = server.clients().at(0);
  EXPECT_GT(counts.lost, 0u);
  EXPECT_LE(counts.waiting * kSize, (1u << 20) + kSize);

  std::uint32_t received = 0;
  std::int64_t last = -1;
  bool reported = false;
  while (last != kMessages - 1 || !reported) {  // the report follows what waited before it
    const Connection::Received frame = slow.ReadFrame();
    ASSERT_FALSE(frame.payload.empty()) << "after " << received << ", the last one " << last;
    if (frame.text) {
      reported = reported || frame.payload.find("reads too slowly") != std::string::npos;
      continue;
    }
    ASSERT_EQ(frame.payload.size(), 13 + kSize);
    std::uint32_t number = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      number |= std::uint32_t{static_cast<unsigned char>(frame.payload[13 + k])} << (8 * k);
    }
    EXPECT_GT(number, last) << "the order stays";
    last = number;
    ++received;
  }
  EXPECT_EQ(received + server.clients().at(0).lost, kMessages);
}

TEST(ViewServer, ThePageReceivesEveryMessageInFewFrames) {
  Server server(SmallServer(), {{ChannelNumber{1}, "a", "A", "struct A {};"}}, Echo);
  Connection page(server.port());
  page.Upgrade(server.port(), "sinew.batch.v1, foxglove.websocket.v1", "sinew.batch.v1");
  page.SendText(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":1}]})");
  ASSERT_TRUE(WaitUntil([&] {
    const auto clients = server.clients();
    return clients.size() == 1 && clients[0].subscriptions == 1;
  }));
  constexpr std::size_t kMessages = 500;
  for (std::size_t i = 0; i < kMessages; ++i) {
    server.Publish(ChannelNumber{1}, static_cast<std::int64_t>(i), {std::byte{7}, std::byte{8}});
  }
  std::size_t received = 0, frames = 0;
  while (received < kMessages) {
    const Connection::Received frame = page.ReadFrame();
    ASSERT_FALSE(frame.payload.empty()) << "after " << received;
    ASSERT_FALSE(frame.text) << frame.payload;
    ++frames;
    // Length 15: opcode, subscription, stamp, two bytes.
    ASSERT_EQ(frame.payload.size() % 19, 0u);
    for (std::size_t at = 0; at < frame.payload.size(); at += 19) {
      EXPECT_EQ(frame.payload.substr(at, 6), std::string("\x0f\0\0\0\x01\x09", 6));
      const auto stamp = static_cast<unsigned char>(frame.payload[at + 9]) |
                         static_cast<unsigned char>(frame.payload[at + 10]) << 8;
      EXPECT_EQ(static_cast<std::size_t>(stamp), received++);
      EXPECT_EQ(frame.payload.substr(at + 17, 2), "\x07\x08");
    }
  }
  EXPECT_EQ(received, kMessages);
  EXPECT_LT(frames, kMessages / 10);
  EXPECT_EQ(server.clients().at(0).sent, kMessages);
  EXPECT_EQ(server.clients().at(0).lost, 0u);
}

TEST(ViewServer, PagesAreAnsweredAndForeignNamesAreNot) {
  Server server(SmallServer(), {}, Echo);
  const std::string host = "127.0.0.1:" + std::to_string(server.port());
  Connection page(server.port());
  page.Send("GET /a/b?c=1 HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  const std::string head = page.ReadHead();
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(head, HasSubstr("frame-ancestors 'none'"));
  EXPECT_EQ(page.Read(12), "GET /a/b c=1");
  page.Send("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  EXPECT_THAT(page.ReadHead(), StartsWith("HTTP/1.1 403"));
  Connection other(server.port());
  other.Send("GET / HTTP/1.1\r\nHost: " + host +
             "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  EXPECT_THAT(other.ReadHead(), StartsWith("HTTP/1.1 404")) << "no live data";
}

TEST(ViewServer, ARequestThatDoesNotEndIsClosed) {
  ServerOptions options = SmallServer();
  options.request_limit = std::chrono::milliseconds(50);
  const Server server(options, {}, Echo);
  const auto begin = std::chrono::steady_clock::now();
  for (const std::string& part :
       {std::string(), std::string("GET / HTTP/1.1\r\nHost: "),
        RequestText(server.port(), "POST /api/estop", "Content-Length: 9\r\n") + "1234"}) {
    Connection half(server.port());
    half.Send(part);
    EXPECT_EQ(half.Read(1), "") << part;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kClientLimit) << "closed, not given up";
}

TEST(ViewServer, ManyProblemsOfAMessageAreAFewReplies) {
  Server server(SmallServer(), {{ChannelNumber{1}, "a", "A", "struct A {};"}}, Echo);
  Connection client(server.port());
  client.Upgrade(server.port());
  std::string numbers = "1";
  for (int i = 0; i < 10000; ++i) numbers += ",1";
  client.SendText("{\"op\":\"unsubscribe\",\"subscriptionIds\":[" + numbers + "]}");
  for (int i = 0; i < 7; ++i) EXPECT_THAT(client.ReadFrame().payload, HasSubstr("subscription 1"));
  EXPECT_THAT(client.ReadFrame().payload, HasSubstr("and more"));
  client.SendText("next");
  EXPECT_THAT(client.ReadFrame().payload, HasSubstr("not a JSON object")) << "it is read again";
}

TEST(ViewServer, APortThatIsTakenIsAnErrorThatNamesIt) {
  const Server server(SmallServer(), {}, Echo);
  ServerOptions same = SmallServer();
  same.port = server.port();
  try {
    const Server second(same, {}, Echo);
    FAIL() << "two servers on one port";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.0.1:" + std::to_string(server.port())));
    EXPECT_THAT(error.what(), HasSubstr("--port"));
  }
}

}  // namespace
}  // namespace sinew::live
