// Topics that a recorder reads.
#pragma once

#include <string>
#include <vector>

#include "components/topics/node/topics.h"

namespace sinew::logger {

// Entries are names of topics, or regular expressions (ECMAScript) that match whole names. All
// topics when `wanted` is empty; those of `unwanted` are left out. recording_progress is read only
// when it is wanted by its name: its numbers depend on the moment, and would make two equal runs
// differ. Throws UsageError naming the option and the entry that matches no topic or is no
// expression, or when nothing is left.
std::vector<const node::TopicInfo*> ChooseTopics(const std::vector<std::string>& wanted,
                                                 const std::vector<std::string>& unwanted);

}  // namespace sinew::logger
