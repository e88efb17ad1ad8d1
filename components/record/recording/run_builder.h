// Builds runs of measured signals out of a recording's messages.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::recording {

// One run per session, in the order they begin; see file/run_reader.h for what becomes a row and a
// signal. `name` stands for the file. Throws McapError for a broken file, std::invalid_argument
// when the recording has no such joint or no rows. `progress` receives the messages read, if given.
std::vector<types::Run> RunsOfRecording(const McapReader& reader, const std::string& name,
                                        int joint,
                                        const std::function<void(std::uint64_t)>& progress = {});

}  // namespace sinew::recording
