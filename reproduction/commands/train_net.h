// `sinew train --net`: any of the published models, from recordings or the surrogate.
#pragma once

#include "tools/sinew/train.h"

namespace sinew::reproduction {

tools::OtherNetworks MakePublishedNetworks();

}  // namespace sinew::reproduction
