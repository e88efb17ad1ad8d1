// The type of a channel's messages, where they can be read: CDR with its own IDL.
#pragma once

#include <map>
#include <memory>
#include <stdexcept>
#include <string>

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

// Topics that a program leaves out, with the reason: "topic '/note' has messages 'json' ...".
using LeftOut = std::map<std::string, std::string>;
// False: with the reason among `left_out`.
bool IsReadable(const McapReader& reader, const McapChannel& channel, LeftOut* left_out);
// Those with a channel that cannot be read.
LeftOut NotReadableTopics(const McapReader& reader);
// The one warning of every program: "FILE: left out: topic ... ; topic ...". Empty: none is.
std::string LeftOutText(const std::string& file, const LeftOut& left_out);

}  // namespace sinew::recording
