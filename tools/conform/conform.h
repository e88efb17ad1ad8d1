// A contract test of a program that takes a role: starts it, plays the rest of the robot for it
// over DDS, and checks what anyone who replaces a participant has to keep.
//
// The program gets the options that `sinew launch` gives: --name, --domain, --seed, in lockstep
// --lockstep, and then its own arguments.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/conform/report.h"

namespace sinew::conform {

struct Options {
  std::string role;                    // one of RoleNames()
  std::filesystem::path program;       // an executable file
  std::vector<std::string> arguments;  // its own, e.g. --config FILE
  int domain_id = 100;                 // where nobody else is
  double rate_Hz = 240.0;
  int joints = 1;
  bool lockstep = true;           // false: the program knows real time only
  std::vector<std::string> only;  // names of checks; empty: all
};

// Names of all checks, in the order of the report.
std::vector<std::string> CheckNames();

// Takes 5 to 10 s. Throws UsageError: no such role or check, or the domain is in use.
Report RunConform(const Options& options);

}  // namespace sinew::conform
