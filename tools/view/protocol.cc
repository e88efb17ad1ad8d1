#include "tools/view/protocol.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "components/base/types/json_text.h"

namespace sinew::live {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint8_t kMessageData = 1;
constexpr int kDeepest = 4;  // a field of an entry of a list of a message

std::optional<std::uint32_t> Number32(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto value = found->get<std::uint64_t>();
  if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

ClientMessage ParseSubscribe(const Json& message) {
  const auto list = message.find("subscriptions");
  if (list == message.end() || !list->is_array()) {
    return Refused{"subscribe: no array 'subscriptions'"};
  }
  Subscribe out;
  for (const Json& entry : *list) {
    const auto id = entry.is_object() ? Number32(entry, "id") : std::nullopt;
    const auto channel = entry.is_object() ? Number32(entry, "channelId") : std::nullopt;
    if (!id || !channel) {
      return Refused{"subscribe: " + types::JsonText(entry) +
                     ", expected {id, channelId} with numbers from 0 to 4294967295"};
    }
    out.items.push_back({SubscriptionNumber{*id}, ChannelNumber{*channel}});
  }
  return out;
}

ClientMessage ParseUnsubscribe(const Json& message) {
  const auto list = message.find("subscriptionIds");
  if (list == message.end() || !list->is_array()) {
    return Refused{"unsubscribe: no array 'subscriptionIds'"};
  }
  Unsubscribe out;
  for (const Json& entry : *list) {
    const bool fits = entry.is_number_unsigned() &&
                      entry.get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max();
    if (!fits) {
      return Refused{"unsubscribe: " + types::JsonText(entry) +
                     ", expected a number from 0 to 4294967295"};
    }
    out.subscriptions.push_back(SubscriptionNumber{entry.get<std::uint32_t>()});
  }
  return out;
}

template <class Value>
void PutLittleEndian(Value value, std::byte* out) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out[i] = static_cast<std::byte>((value >> (8 * i)) & 0xff);
  }
}

}  // namespace

std::string ServerInfoText(std::string_view name, std::string_view session) {
  return types::JsonText(Json{{"op", "serverInfo"},
                              {"name", name},
                              {"capabilities", Json::array()},
                              {"supportedEncodings", {"cdr"}},
                              {"metadata", Json::object()},
                              {"sessionId", session}});
}

std::string AdvertiseText(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", static_cast<std::uint32_t>(channel.number)},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.schema_name},
                    {"schema", channel.schema},
                    {"schemaEncoding", "omgidl"}});
  }
  return types::JsonText(Json{{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string StatusText(StatusLevel level, std::string_view message, std::string_view id) {
  Json status = {{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}};
  if (!id.empty()) status["id"] = id;
  // A client's own words may stand in the message: bytes that are no UTF-8 are replaced.
  return types::JsonText(status);
}

ClientMessage ParseClientText(std::string_view text) {
  Json message;
  try {
    message = types::ParseJson<Json>(text, "", kDeepest);
  } catch (const std::invalid_argument&) {  // no object
  }
  if (!message.is_object()) return Refused{"not a JSON object"};
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string()) return Refused{"no text 'op'"};
  if (*op == "subscribe") return ParseSubscribe(message);
  if (*op == "unsubscribe") return ParseUnsubscribe(message);
  return Refused{"'" + op->get<std::string>() +
                 "' is not offered by this server, expected subscribe or unsubscribe"};
}

DataHead MessageDataHead(SubscriptionNumber subscription, std::int64_t stamp_ns) {
  DataHead head;
  head[0] = std::byte{kMessageData};
  PutLittleEndian(static_cast<std::uint32_t>(subscription), head.data() + 1);
  PutLittleEndian(static_cast<std::uint64_t>(std::max<std::int64_t>(stamp_ns, 0)), head.data() + 5);
  return head;
}

void AppendToBatch(const DataHead& head, std::span<const std::byte> payload,
                   std::vector<std::byte>* batch) {
  std::array<std::byte, sizeof(std::uint32_t)> length{};
  PutLittleEndian(static_cast<std::uint32_t>(head.size() + payload.size()), length.data());
  batch->insert(batch->end(), length.begin(), length.end());
  batch->insert(batch->end(), head.begin(), head.end());
  batch->insert(batch->end(), payload.begin(), payload.end());
}

std::string_view ChooseSubprotocol(std::string_view header) {
  while (!header.empty()) {
    const std::size_t comma = std::min(header.find(','), header.size());
    std::string_view word = header.substr(0, comma);
    while (!word.empty() && (word.front() == ' ' || word.front() == '\t')) word.remove_prefix(1);
    while (!word.empty() && (word.back() == ' ' || word.back() == '\t')) word.remove_suffix(1);
    for (const std::string_view ours : {kSubprotocol, kSdkSubprotocol, kBatchSubprotocol}) {
      if (word == ours) return ours;
    }
    header.remove_prefix(std::min(comma + 1, header.size()));
  }
  return {};
}

}  // namespace sinew::live
