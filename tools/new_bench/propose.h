// The two files of a bench of one's own, from the header and the first rows of a CSV file: which
// column is probably which signal in which unit, and a model of one joint that lets a fit find its
// values. What was guessed, and why, stands beside it for a person to check.
//
// Pure; set-up only.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/signal.h"
#include "components/record/recording/csv.h"

namespace sinew::new_bench {

struct Column {
  std::string name;
  std::optional<types::Signal> signal{};  // nothing: time
  std::string unit{};
  std::string why{};  // "unit by its name", "rad assumed: no unit in its name"
};

struct Guess {
  recording::CsvFormat format{};
  std::vector<Column> columns{};      // one for each signal at most; time first, if there is one
  std::vector<std::string> unused{};  // of the file
  double split_s = 0.0;               // on its clock, after 0.6 of its time
};

// given: the columns of a file without a header. Throws std::invalid_argument naming the file: no
// header, or no column that may be an angle or none that may be a drive (current, torque or
// voltage).
Guess GuessColumns(std::string_view text, const std::string& name,
                   std::vector<std::string> given = {});

// Answers to what no file contains.
struct Answers {
  std::string joint = "joint";
  double gear_ratio = 1.0;
  double torque_constant_Nm_A = 0.0;  // needed where the drive is a current
  int drive_sign = 1;                 // -1: a positive drive lowers the position
  // Reading of the position, in the column's unit, where the link hangs straight down; nothing:
  // gravity does not load the joint.
  std::optional<double> hanging{};
};

bool NeedsTorqueConstant(const Guess& guess);

struct Files {
  std::string csv_map, model, readme;
};

// Throws std::invalid_argument for a torque constant or a gear ratio that is not above 0.
Files Propose(const Guess& guess, const Answers& answers, const std::string& recording);

}  // namespace sinew::new_bench
