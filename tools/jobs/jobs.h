// Independent jobs on a few threads, with a count for a progress bar.
#pragma once

#include <functional>
#include <vector>

namespace sinew::tools {

// Runs every job once, on `threads` threads (at least 1). `progress` is called in the calling
// thread, about ten times a second and at the end, with the number of jobs done; may be empty. The
// first exception of a job ends the rest and is thrown here.
void RunJobs(const std::vector<std::function<void()>>& jobs, int threads,
             const std::function<void(std::size_t)>& progress = {});

}  // namespace sinew::tools
