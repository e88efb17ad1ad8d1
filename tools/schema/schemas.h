// The configurations that are described (components/base/config/fields.h).
#pragma once

#include <string>
#include <vector>

#include "components/base/config/fields.h"

namespace sinew::schema {

struct Schema {
  std::string name;  // as in the files: "sinew-control/1"
  void (*describe)(config::Fields& fields);

  // With the key `schema`.
  config::Shape MakeShape() const;
  std::string FileName() const;  // "control-1.json"
};

// By name.
const std::vector<Schema>& AllSchemas();
// With or without the version: "sinew-control/1", "sinew-control", "control". Throws UsageError.
const Schema& FindSchema(const std::string& name);

}  // namespace sinew::schema
