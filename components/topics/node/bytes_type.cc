#include "components/topics/node/bytes_type.h"

#include <cstring>

#include "components/topics/node/codec.h"

namespace sinew::node::internal {

namespace rtps = eprosima::fastrtps::rtps;

BytesType::BytesType(const TopicInfo& topic) : type_name_(topic.type_name) {
  setName(topic.dds_type_name.c_str());
  m_typeSize = static_cast<std::uint32_t>(MaxEncodedSize(topic.type_name));
  m_isGetKeyDefined = IsKeyed(topic.type_name);
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool BytesType::serialize(void* data, rtps::SerializedPayload_t* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(data);
  if (bytes.size() < 4 || bytes.size() > payload->max_size) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = (bytes[1] & std::byte{1}) != std::byte{0} ? CDR_LE : CDR_BE;
  return true;
}

bool BytesType::deserialize(rtps::SerializedPayload_t* payload, void* data) {
  Bytes& bytes = *static_cast<Bytes*>(data);
  const auto* begin = reinterpret_cast<const std::byte*>(payload->data);
  bytes.assign(begin, begin + payload->length);
  return true;
}

std::function<uint32_t()> BytesType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
}

void* BytesType::createData() { return new Bytes; }
void BytesType::deleteData(void* data) { delete static_cast<Bytes*>(data); }

bool BytesType::getKey(void* data, rtps::InstanceHandle_t* handle, bool /*force_md5*/) {
  if (!m_isGetKeyDefined) return false;
  std::uint8_t hash[16];
  if (!KeyHash(type_name_, *static_cast<const Bytes*>(data), hash)) return false;
  for (int i = 0; i < 16; ++i) handle->value[i] = hash[i];
  return true;
}

}  // namespace sinew::node::internal
