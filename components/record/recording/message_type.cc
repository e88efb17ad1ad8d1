#include "components/record/recording/message_type.h"

namespace sinew::recording {

MessageType MessageTypeOf(const McapReader& reader, const McapChannel& channel) {
  const std::string topic = "topic '" + channel.topic + "' has ";
  const McapSchema* schema = reader.SchemaOf(channel);
  if (schema == nullptr || schema->encoding != "omgidl" || channel.message_encoding != "cdr") {
    throw NotReadable(topic + "messages '" + channel.message_encoding + "' with " +
                      (schema == nullptr ? "no schema" : "a schema '" + schema->encoding + "'") +
                      ", expected 'cdr' with 'omgidl'");
  }
  try {
    MessageType out;
    out.idl = std::make_shared<const IdlSchema>(IdlSchema::Parse(schema->data));
    out.type = &out.idl->Struct(schema->name);
    return out;
  } catch (const IdlError& error) {
    throw NotReadable(topic + "an IDL that is not understood: " + error.what());
  }
}

bool IsReadable(const McapReader& reader, const McapChannel& channel, LeftOut* left_out) {
  try {
    (void)MessageTypeOf(reader, channel);
    return true;
  } catch (const NotReadable& error) {
    left_out->emplace(channel.topic, error.what());
    return false;
  }
}

LeftOut NotReadableTopics(const McapReader& reader) {
  LeftOut left_out;
  for (const auto& [id, channel] : reader.channels()) (void)IsReadable(reader, channel, &left_out);
  return left_out;
}

std::string LeftOutText(const std::string& file, const LeftOut& left_out) {
  std::string text;
  for (const auto& [topic, why] : left_out) {
    text += (text.empty() ? file + ": left out: " : "; ") + why;
  }
  return text;
}

}  // namespace sinew::recording
