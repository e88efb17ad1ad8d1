// The Foxglove WebSocket protocol, as far as a server that only sends needs it
// (https://github.com/foxglove/ws-protocol, docs/spec.md): texts and frames, without sockets.
//
// Our own page takes a second subprotocol, which differs in the binary frames alone: each is a
// batch of message data frames, one after the other, with their length (uint32, little-endian)
// before each. A browser needs more time for a frame than for what is in it.
//
// Pure: any thread. Client publishing, parameters and services are not offered.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sinew::live {

inline constexpr std::string_view kSubprotocol = "foxglove.websocket.v1";
// The same by the name that clients of 2025 on may offer alone.
inline constexpr std::string_view kSdkSubprotocol = "foxglove.sdk.v1";
inline constexpr std::string_view kBatchSubprotocol = "sinew.batch.v1";

// Numbers of the channels, from 1 on; of a client's subscriptions, which the client numbers.
enum class ChannelNumber : std::uint32_t {};
enum class SubscriptionNumber : std::uint32_t {};

// A topic as clients see it: messages are CDR with its 4-byte header, the schema is flattened IDL.
struct Channel {
  ChannelNumber number{};
  std::string topic;
  std::string schema_name;  // "sinew::msg::JointState"
  std::string schema;       // IDL
};

enum class StatusLevel { kInfo = 0, kWarning = 1, kError = 2 };

// JSON texts. session: changes with every start of the server.
std::string ServerInfoText(std::string_view name, std::string_view session);
std::string AdvertiseText(const std::vector<Channel>& channels);
// A later status of the same id takes the place of the earlier one; empty: none.
std::string StatusText(StatusLevel level, std::string_view message, std::string_view id = {});

struct Subscribe {
  struct Item {
    SubscriptionNumber subscription{};
    ChannelNumber channel{};
  };
  std::vector<Item> items;
};
struct Unsubscribe {
  std::vector<SubscriptionNumber> subscriptions;
};
// Not as the protocol says, or not offered: what, for the client.
struct Refused {
  std::string why;
};
using ClientMessage = std::variant<Subscribe, Unsubscribe, Refused>;
ClientMessage ParseClientText(std::string_view text);

// Bytes before the payload of a message data frame: opcode 1, subscription (uint32), stamp (uint64,
// ns), little-endian. A stamp before 1970 is sent as 0.
using DataHead = std::array<std::byte, 13>;
DataHead MessageDataHead(SubscriptionNumber subscription, std::int64_t stamp_ns);

void AppendToBatch(const DataHead& head, std::span<const std::byte> payload,
                   std::vector<std::byte>* batch);

// The first of our subprotocols that a Sec-WebSocket-Protocol header ("a, b") offers; empty: none.
std::string_view ChooseSubprotocol(std::string_view header);

}  // namespace sinew::live
