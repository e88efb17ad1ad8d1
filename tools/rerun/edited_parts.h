// Components with other values in their configuration: what would they have done?
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/compose/chain.h"

namespace sinew::rerun {

struct Edit {
  std::string component;  // empty: every one that has the entry
  std::string key;
  std::string value;  // YAML; a path relative to the working folder where it names a file
};

// KEY=VALUE or COMPONENT.KEY=VALUE. Throws UsageError.
Edit ParseEdit(const std::string& text);

// The parts whose configurations have an entry that an edit changes, at any depth, with
// configurations as folder/NAME.yaml; their paths stay those of the originals. Throws UsageError:
// an edit that changes nothing, a value that is no YAML, files.
std::vector<compose::Part> EditParts(const std::vector<compose::Part>& parts,
                                     const std::vector<Edit>& edits,
                                     const std::filesystem::path& folder);

}  // namespace sinew::rerun
