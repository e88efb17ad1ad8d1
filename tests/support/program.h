// Programs under test, under the name that tests use.
#pragma once

#include "tools/launch/program.h"

namespace sinew::testing {

using launch::Finished;
using launch::IsRunning;
using launch::Program;
using launch::Run;
using launch::WaitUntilGone;

}  // namespace sinew::testing
