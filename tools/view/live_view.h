// sinew-view on a domain: reads every topic, serves the page and the Foxglove protocol.
#pragma once

#include "components/topics/node/options.h"
#include "tools/view/page.h"
#include "tools/view/robot.h"
#include "tools/view/view_config.h"

namespace sinew::live {

// Until it is stopped; logs the page's address. robot may be null. Throws UsageError (port,
// recording) and node::DdsError.
void RunLive(const node::Options& options, const node::StopFlag& stop, const ViewOptions& view,
             const Page& page, const Robot* robot);

// The same page for a recording; needs no DDS.
void RunRecorded(const node::Options& options, const node::StopFlag& stop, const ViewOptions& view,
                 const Page& page, const Robot* robot);

}  // namespace sinew::live
