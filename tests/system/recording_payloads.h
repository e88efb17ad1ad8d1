// What a recording holds, topic by topic, for comparing runs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sinew::testing {

// Payload bytes in the order of the file, by topic. Throws what the reader throws.
std::map<std::string, std::vector<std::string>> PayloadsByTopic(const std::filesystem::path& file);

}  // namespace sinew::testing
