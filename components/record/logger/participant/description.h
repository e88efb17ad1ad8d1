// Description of where a recording comes from: metadata and attachments. Any thread.
#pragma once

#include <string>
#include <vector>

#include "components/record/recording/mcap.h"
#include "components/topics/node/node.h"

namespace sinew::logger {

struct Description {
  std::vector<recording::McapMetadata> metadata;  // sinew.recording, and sinew.files if any
  std::vector<recording::McapAttachment> attachments;
};

// notes: KEY=VALUE for sinew.recording. files: FILE or NAME=FILE, attached; their hashes go into
// sinew.files. Throws UsageError for a note or a file that is none.
Description Describe(const node::Options& options, const std::vector<std::string>& notes,
                     const std::vector<std::string>& files);

// Name of the participant that has this writer, for a channel; nothing when it is not known.
recording::TextMap DescribeWriter(const node::Node& node, const node::WriterId& writer);

}  // namespace sinew::logger
