// The table of a gain search on disk: JSON lines, the first of them the search, then one a trial as
// soon as it is run. A search that was killed goes on from it; a line that was cut is run again.
//
//     {"schema": "sinew-tune-trials/1", "trials": 120, "seed": 1, "inputs": {"world": "<hash>",
//     ...}}
//     {"stage": 1, "trial": 0, "name": "", "proportional_Nm_rad": ..., "integral_Nm_rad_s": ...,
//      "derivative_Nm_s_rad": ..., "mse_rad2": ..., "worst_rad": ..., "torque_rms_Nm": ...,
//      "torque_change_rms_Nm": ..., "saturated_share": ..., "faulted": false, "fell_at_s": null}
//
// Errors and torques of a trial that fell (fell_at_s: from arming) are those of the ticks before.
#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/tune_robot/gain_search.h"

namespace sinew::tune {

// Identity of a search: another table goes on with nothing but the same.
struct TableHead {
  int trials = 0;
  std::uint64_t seed = 0;
  // 16 hex digits of FNV-1a over each input file, by what it is ("world").
  std::map<std::string, std::string> inputs;
};

// The hash of TableHead::inputs. Throws UsageError naming a file that cannot be read.
std::string HashOfFile(const std::filesystem::path& path);

class TrialTable {
 public:
  // Opens the table, or begins one; a last line that was cut is taken away. Throws UsageError:
  // file and line of what is no table, what differs from `head`, the system's reason.
  TrialTable(const std::filesystem::path& path, const TableHead& head);

  const std::vector<GainTrial>& known() const noexcept { return known_; }
  // One thread at a time. The line is with the system when it returns. Throws UsageError.
  void Append(const GainTrial& trial);
  // The whole table by stage and number, in place of what is there; nothing may be appended
  // afterwards. Throws UsageError.
  void Finish(const std::vector<GainTrial>& trials);

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  [[noreturn]] void FailToWrite() const;
  void Read(const std::string& text);
  void Write(const std::string& line);

  std::filesystem::path path_;
  std::string head_;
  std::vector<GainTrial> known_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace sinew::tune
