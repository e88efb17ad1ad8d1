#include "components/record/logger/participant/description.h"

#include <sys/timex.h>
#include <sys/utsname.h>

#include <fstream>

#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/clock/utc.h"
#include "components/record/logger/file/attached_file.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/version.h"

namespace sinew::logger {

namespace {

// Reception stamps are this machine's CLOCK_REALTIME: how far it can be trusted.
void DescribeClock(recording::TextMap* values) {
  timex state{};
  const int status = ::adjtimex(&state);  // reads, changes nothing
  (*values)["clock"] = "CLOCK_REALTIME";
  (*values)["clock_synchronized"] = status >= 0 && status != TIME_ERROR ? "yes" : "no";
  if (status >= 0 && status != TIME_ERROR) {
    (*values)["clock_error_max_us"] = std::to_string(state.maxerror);
  }
  (*values)["clock_minus_monotonic_ns"] =
      std::to_string(types::EpochNow_ns() - types::MonotonicNow_ns());
  std::string source;
  if (std::ifstream("/sys/devices/system/clocksource/clocksource0/current_clocksource") >> source) {
    (*values)["clock_source"] = source;
  }
}

void DescribeMachine(recording::TextMap* values) {
  (*values)["host"] = node::HostName();
  utsname system{};
  if (::uname(&system) == 0) {
    (*values)["system"] = std::string(system.sysname) + " " + system.release + " " + system.machine;
  }
#ifdef __clang__
  (*values)["compiler"] = std::string("clang ") + __clang_version__;
#else
  (*values)["compiler"] = std::string("gcc ") + __VERSION__;
#endif
}

}  // namespace

Description Describe(const node::Options& options, const std::vector<std::string>& notes,
                     const std::vector<std::string>& files) {
  recording::McapMetadata recorded{"sinew.recording", {}};
  for (const std::string& note : notes) {
    const std::size_t equals = note.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError("--note: '" + note + "', expected KEY=VALUE");
    }
    recorded.values[note.substr(0, equals)] = note.substr(equals + 1);
  }
  recorded.values["version"] = node::kVersion;
  recorded.values["topics_hash"] = node::AllTopicsHash();
  recorded.values["domain_id"] = std::to_string(options.domain_id);
  recorded.values["mode"] = options.mode == node::TimeMode::kLockstep ? "lockstep" : "realtime";
  recorded.values["seed"] = std::to_string(options.seed);
  recorded.values["recorder"] = options.name;
  recorded.values["started"] = types::UtcNow();
  DescribeMachine(&recorded.values);
  DescribeClock(&recorded.values);

  Description description;
  recording::McapMetadata hashes{"sinew.files", {}};
  for (const std::string& file : files) {
    AttachedFile attached = ReadAttachedFile(file);
    if (!hashes.values.emplace(attached.name, "sha256:" + attached.sha256).second) {
      throw UsageError("--attach: the name '" + attached.name +
                       "' is there twice, expected NAME=FILE with a name of its own");
    }
    if (attached.attached) description.attachments.push_back(std::move(attached.attachment));
  }
  description.metadata.push_back(std::move(recorded));
  if (!hashes.values.empty()) description.metadata.push_back(std::move(hashes));
  return description;
}

recording::TextMap DescribeWriter(const node::Node& node, const node::WriterId& writer) {
  const auto name = node.NameOf(writer);
  if (!name) return {};
  return {{"participant", name->participant}};
}

}  // namespace sinew::logger
