// The measurements of this program. Each prints its table and gives whether its goal was met.
#pragma once

#include <filesystem>
#include <string>

namespace sinew::logger_bench {

struct CpuOptions {
  int domain_id = 0;
  double rate_Hz = 1000.0;
  double seconds = 10.0;
  std::filesystem::path folder;  // for recordings
  std::string compression = "none";
};
bool MeasureCpu(const CpuOptions& options);
bool MeasureLcm(const CpuOptions& options);  // lcm-logger and lcm-logplayer in the PATH
// The process that it is compared with: reads the same topics and does nothing, until SIGTERM.
void ReadInVain(int domain_id);

struct KillOptions {
  int domain_id = 0;
  double rate_Hz = 1000.0;
  int count = 200;
  unsigned seed = 1;
  std::filesystem::path folder;
};
bool MeasureKills(const KillOptions& options);

struct HourOptions {
  double hours = 8.0;
  double rate_Hz = 100.0;
  double split_hours = 1.0;  // 0: one file
};
bool MeasureHours(const HourOptions& options);

}  // namespace sinew::logger_bench
