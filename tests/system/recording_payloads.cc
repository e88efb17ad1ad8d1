#include "tests/system/recording_payloads.h"

#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::testing {

std::map<std::string, std::vector<std::string>> PayloadsByTopic(const std::filesystem::path& file) {
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  recording::McapMessages messages = reader.Messages();
  std::map<std::string, std::vector<std::string>> payloads;
  recording::McapMessage message;
  while (messages.Next(&message)) {
    const auto* begin = reinterpret_cast<const char*>(message.data.data());
    payloads[reader.channels().at(message.channel_id).topic].emplace_back(
        begin, begin + message.data.size());
  }
  return payloads;
}

}  // namespace sinew::testing
