// CPU time of another process.
#pragma once

#include <sys/types.h>

namespace sinew::logger_bench {

// User and system time so far, s. 0 when there is no such process.
double CpuOf_s(pid_t pid);

}  // namespace sinew::logger_bench
