// Recordings of a standing robot from MCAP files: joints, forces of the feet and IMU, row by row.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/stance_fit/stance_model.h"
#include "components/record/recording/body_builder.h"

namespace sinew::stance_fit {

// A recording is cut where a step of its time is longer than this many of its periods (the median
// step): derivatives go across no hole. One lost row is two periods.
inline constexpr double kLongestStep = 1.5;
// Shorter pieces are left out: the borders of the slowest low-pass (identify/processing_settings.h)
// take them whole.
inline constexpr double kShortestPiece_s = 2.0;

// The rows whose time joints and body share, in pieces. joints: one run per joint of the model, of
// one session, times as in `body`. Throws std::invalid_argument naming `name`: no piece is long
// enough, or joints without the signal that the drive term of their model needs.
std::vector<StanceRecording> JoinRows(const std::string& name, const actuator::RobotModel& robot,
                                      std::vector<types::Run> joints,
                                      const recording::BodyRun& body);

// FILE or FILE@START:END, an MCAP recording of one session. Throws UsageError naming file, and
// topic, joint or signal: a CSV file, a recording without foot_force or imu, with fewer joints than
// the model.
std::vector<StanceRecording> ReadStance(const std::filesystem::path& path,
                                        const actuator::RobotModel& robot);

}  // namespace sinew::stance_fit
