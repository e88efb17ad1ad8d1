#include "components/topics/node/codec.h"

#include <cstring>
#include <stdexcept>

#include "components/base/types/fnv1a.h"
#include "components/topics/node/all_checks.h"
#include "components/topics/node/all_codecs.h"
#include "components/topics/node/all_messages.h"

namespace sinew::node {

namespace {

using eprosima::fastdds::dds::TopicDataType;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SerializedPayload_t;

// A payload that borrows bytes instead of owning them.
class BorrowedPayload {
 public:
  BorrowedPayload(std::byte* data, std::size_t size) {
    payload_.data = reinterpret_cast<octet*>(data);
    payload_.max_size = static_cast<std::uint32_t>(size);
    payload_.length = static_cast<std::uint32_t>(size);
  }
  ~BorrowedPayload() { payload_.data = nullptr; }
  SerializedPayload_t* get() { return &payload_; }

 private:
  SerializedPayload_t payload_;
};

std::unique_ptr<TopicDataType> MakeType(std::string_view type_name) {
#define SINEW_MAKE(Type) \
  if (type_name == "sinew::msg::" #Type) return std::make_unique<msg::Type##PubSubType>();
  SINEW_FOR_EACH_MESSAGE(SINEW_MAKE)
#undef SINEW_MAKE
  throw std::invalid_argument("no such topic type: " + std::string(type_name));
}

template <class PubSubType, class Message>
bool EncodeAs(const Message& message, Bytes* bytes) {
  thread_local PubSubType type;
  bytes->resize(type.m_typeSize);
  BorrowedPayload payload(bytes->data(), bytes->size());
  // serialize() does not change the message; the interface of the DDS library is not const.
  const bool ok = type.serialize(const_cast<Message*>(&message), payload.get());
  bytes->resize(ok ? payload.get()->length : 0);
  return ok;
}

template <class PubSubType, class Message>
bool DecodeAs(const Bytes& bytes, Message* message) {
  if (bytes.size() < 4) return false;
  thread_local PubSubType type;
  BorrowedPayload payload(const_cast<std::byte*>(bytes.data()), bytes.size());
  try {
    return type.deserialize(payload.get(), message) && internal::HasMeaning(*message);
  } catch (const std::exception&) {
    return false;
  }
}

std::uint64_t Load64(const std::byte* bytes, bool little) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) {
    const int shift = little ? 8 * i : 8 * (7 - i);
    value |= static_cast<std::uint64_t>(bytes[i]) << shift;
  }
  return value;
}

}  // namespace

#define SINEW_CODEC(Type)                                          \
  template <>                                                      \
  bool Encode<msg::Type>(const msg::Type& message, Bytes* bytes) { \
    return EncodeAs<msg::Type##PubSubType>(message, bytes);        \
  }                                                                \
  template <>                                                      \
  bool Decode<msg::Type>(const Bytes& bytes, msg::Type* message) { \
    return DecodeAs<msg::Type##PubSubType>(bytes, message);        \
  }                                                                \
  template <>                                                      \
  std::string_view TypeName<msg::Type>() {                         \
    return "sinew::msg::" #Type;                                   \
  }
SINEW_FOR_EACH_MESSAGE(SINEW_CODEC)
#undef SINEW_CODEC

std::uint64_t EventId(std::span<const std::byte> canonical_payload) {
  types::Fnv1a hash;
  hash.Add(canonical_payload);
  return hash.value();
}

constexpr std::size_t kOriginOffset = 4 + 8 + 8 + 8;  // encapsulation, session, tick, stamp

bool PeekHead(const std::byte* bytes, std::size_t size, HeadOfMessage* head) {
  if (size < kOriginOffset + 4) return false;
  const bool little = (bytes[1] & std::byte{1}) != std::byte{0};
  head->session_id = Load64(bytes + 4, little);
  head->tick = Load64(bytes + 12, little);
  head->origin = 0;
  for (int i = 0; i < 4; ++i) {
    const int shift = little ? 8 * i : 8 * (3 - i);
    head->origin |= static_cast<std::uint32_t>(bytes[kOriginOffset + static_cast<std::size_t>(i)])
                    << shift;
  }
  return true;
}

bool PokeOrigin(std::byte* bytes, std::size_t size, std::uint32_t origin) {
  if (size < kOriginOffset + 4) return false;
  const bool little = (bytes[1] & std::byte{1}) != std::byte{0};
  for (int i = 0; i < 4; ++i) {
    const int shift = little ? 8 * i : 8 * (3 - i);
    bytes[kOriginOffset + static_cast<std::size_t>(i)] =
        static_cast<std::byte>((origin >> shift) & 0xFF);
  }
  return true;
}

bool KeyHash(std::string_view type_name, const Bytes& bytes, std::uint8_t hash[16]) {
  const std::unique_ptr<TopicDataType> type = MakeType(type_name);
  if (!type->m_isGetKeyDefined || bytes.size() < 4) return false;
  void* data = type->createData();
  BorrowedPayload payload(const_cast<std::byte*>(bytes.data()), bytes.size());
  InstanceHandle_t handle;
  bool ok = false;
  try {
    ok = type->deserialize(payload.get(), data) && type->getKey(data, &handle, false);
  } catch (const std::exception&) {
    ok = false;
  }
  type->deleteData(data);
  if (ok) {
    for (int i = 0; i < 16; ++i) hash[i] = handle.value[i];
  }
  return ok;
}

std::size_t MaxEncodedSize(std::string_view type_name) { return MakeType(type_name)->m_typeSize; }

bool IsKeyed(std::string_view type_name) { return MakeType(type_name)->m_isGetKeyDefined; }

}  // namespace sinew::node
