// Messages of this build's topics for tests, made without DDS.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "components/record/recording/cdr.h"
#include "components/record/recording/run_import.h"
#include "idl/embedded_idl.h"

namespace sinew::testing {

inline recording::TopicSchema SchemaOf(std::string_view topic) {
  static const std::map<std::string, std::string> kTypes = {
      {"joint_state", "sinew::msg::JointState"},
      {"actuator_state", "sinew::msg::ActuatorState"},
      {"reference", "sinew::msg::Reference"},
      {"component_status", "sinew::msg::ComponentStatus"},
      {"operator_command", "sinew::msg::OperatorCommand"}};
  for (const idl::EmbeddedType& type : idl::EmbeddedTypes()) {
    if (type.type_name == kTypes.at(std::string(topic))) {
      return {std::string(topic), std::string(type.type_name), std::string(type.text),
              std::string(type.hash)};
    }
  }
  throw std::logic_error("no type for " + std::string(topic));
}

// A message with some fields set.
inline recording::Bytes MakeMessage(const std::string& topic,
                                    const std::map<std::string, double>& fields) {
  const recording::TopicSchema schema = SchemaOf(topic);
  const recording::IdlSchema idl = recording::IdlSchema::Parse(schema.idl);
  const recording::IdlType& type = idl.Struct(schema.type_name);
  recording::Bytes bytes = recording::ZeroCdr(type);
  for (const auto& [path, value] : fields) recording::CdrField(type, path).Set(bytes, value);
  return bytes;
}

inline double FieldOf(const std::string& topic, std::span<const std::byte> payload,
                      const std::string& path) {
  const recording::TopicSchema schema = SchemaOf(topic);
  const recording::IdlSchema idl = recording::IdlSchema::Parse(schema.idl);
  return recording::CdrField(idl.Struct(schema.type_name), path).AsDouble(payload);
}

}  // namespace sinew::testing
