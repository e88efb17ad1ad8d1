// The blocks `processing` and `as_published` of a model file.
//
// Throws UsageError with file, line, key and what was expected.
#pragma once

#include <optional>

#include "components/base/config/fields.h"
#include "components/model/effects/effect.h"
#include "components/model/identify/as_published.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

void Describe(config::Fields& f, ProcessingOptions& c);
void Describe(config::Fields& f, AsPublishedOptions& c);

// root: the whole model file.
ProcessingOptions ReadProcessing(const config::Section& root, types::JointKind kind);
std::optional<AsPublishedOptions> ReadAsPublished(const config::Section& root);

}  // namespace sinew::identify
