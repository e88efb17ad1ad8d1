// The DDS type of every topic: messages travel as bytes.
//
// Messages are encoded and decoded by the caller's thread (codec.h); Fast DDS only copies bytes and
// asks for the key.
#pragma once

#include "components/topics/node/dds_pch.h"
#include "components/topics/node/topics.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

class BytesType : public dds::TopicDataType {
 public:
  explicit BytesType(const TopicInfo& topic);
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

 private:
  std::string type_name_;
};

}  // namespace sinew::node::internal
