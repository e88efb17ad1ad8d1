// Rows of an experiment from a run of measured signals (a recording read with
// components/record/recording).
#pragma once

#include <string>

#include "components/base/types/run.h"
#include "components/model/experiment/protocol.h"

namespace sinew::experiment {

// Rows from from_s on, times counted from there. Needs position, motor_position and motor_current;
// what else is missing stays 0. Throws std::invalid_argument naming the signal.
Recording RowsOfRun(const types::Run& run, double from_s);

// The rows as CSV; robots/rig/experiment_map.yaml says what the columns are.
std::string FormatCsv(const Recording& rows);

}  // namespace sinew::experiment
