// The type of a channel's messages, where they can be read: CDR with its own IDL.
#pragma once

#include <memory>
#include <stdexcept>

#include "components/record/recording/idl_schema.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::recording {

// "topic '/note' has messages 'json' with a schema 'jsonschema', expected 'cdr' with 'omgidl'".
class NotReadable : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

struct MessageType {
  std::shared_ptr<const IdlSchema> idl;  // keeps `type`
  const IdlType* type = nullptr;
};

// Throws NotReadable: another encoding or no schema, IDL that is not understood or lacks the
// struct.
MessageType MessageTypeOf(const McapReader& reader, const McapChannel& channel);

}  // namespace sinew::recording
