// Makes a whole file of one that was cut off: everything up to its last whole record, with index
// and summary.
#pragma once

#include "components/record/recording/io.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::recording {

// Writes what a cut-off file still holds: metadata, attachments, schemas, channels and messages in
// the order of their log time, numbered from 0 on per channel, and a metadata record
// `sinew.recovered` that says how much was lost. `reader` must be of a cut-off file
// (McapReader::recovery). Throws McapError when the source cannot be read; a failure of the sink is
// returned.
IoStatus RecoverMcap(const McapReader& reader, ByteSink& sink);

}  // namespace sinew::recording
