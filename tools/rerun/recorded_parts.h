// Components with which a recording can be run again, and their configuration: from a deployment
// file, or from the files that are attached to the recording.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/options.h"
#include "tools/compose/chain.h"
#include "tools/launch/deployment.h"

namespace sinew::rerun {

// Writes the attachments of a recording below `folder`, each under its own name, and returns the
// deployment among them (the one file with the schema sinew-deployment/1). Throws UsageError when
// there is none or more than one, or a name leads out of the folder.
std::filesystem::path UnpackDeployment(const recording::McapReader& reader, const std::string& file,
                                       const std::filesystem::path& folder);

// The processes of a deployment as parts. names: those wanted; empty: all that can run in process
// (compose::ComposedPrograms). Throws UsageError for a name that is not there, and for a process
// that has arguments of its own, whose meaning only its main() knows.
std::vector<compose::Part> PartsOf(const launch::Deployment& deployment,
                                   const std::vector<std::string>& names);

// As the recording's metadata say ("mode" of sinew.recording); where tools have dropped them, that
// of the deployment with its --set. Throws UsageError without either.
node::TimeMode ModeOf(const recording::McapReader& reader, const std::string& file,
                      std::optional<node::TimeMode> deployed = std::nullopt);

}  // namespace sinew::rerun
