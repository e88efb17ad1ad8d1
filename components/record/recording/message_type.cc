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

}  // namespace sinew::recording
