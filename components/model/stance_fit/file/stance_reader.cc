#include "components/model/stance_fit/file/stance_reader.h"

#include <algorithm>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/median.h"
#include "components/model/identify/interpolated.h"
#include "components/model/identify/processing.h"
#include "components/record/recording/file/run_reader.h"

namespace sinew::stance_fit {
namespace {

using RowNumbers = std::vector<Eigen::Index>;

// Row numbers of equal times, of every series; all strictly increasing.
std::vector<RowNumbers> SharedRows(const std::vector<const Eigen::VectorXd*>& times) {
  std::vector<RowNumbers> out(times.size());
  RowNumbers at(times.size(), 0);
  while (true) {
    double latest = 0.0;
    for (std::size_t s = 0; s < times.size(); ++s) {
      if (at[s] >= times[s]->size()) return out;
      const double time = (*times[s])[at[s]];
      latest = s == 0 ? time : std::max(latest, time);
    }
    bool shared = true;
    for (std::size_t s = 0; s < times.size(); ++s) {
      while (at[s] < times[s]->size() && (*times[s])[at[s]] < latest) ++at[s];
      if (at[s] >= times[s]->size()) return out;
      shared = shared && (*times[s])[at[s]] == latest;
    }
    if (!shared) continue;
    for (std::size_t s = 0; s < times.size(); ++s) out[s].push_back(at[s]++);
  }
}

double MedianStep(const Eigen::VectorXd& time_s) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  return types::UpperMedian(std::move(steps));
}

}  // namespace

std::vector<StanceRecording> JoinRows(const std::string& name, const actuator::RobotModel& robot,
                                      std::vector<types::Run> joints,
                                      const recording::BodyRun& body) {
  std::vector<const Eigen::VectorXd*> times = {&body.time_s};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j].name = name;
    times.push_back(&joints[j].time_s);
    const types::Signal drive = identify::DriveSignal(robot.joints.at(j));
    if (!joints[j].Has(types::Signal::kPosition) || !joints[j].Has(drive)) {
      throw std::invalid_argument(
          name + ": joint '" + robot.joints[j].name + "' has no measured " +
          std::string(types::SignalName(joints[j].Has(drive) ? types::Signal::kPosition : drive)) +
          ", expected it in actuator_state");
    }
  }
  const std::vector<RowNumbers> shared = SharedRows(times);
  std::vector<StanceRecording> out;
  const auto rows = static_cast<Eigen::Index>(shared.front().size());
  if (rows > 1) {
    const Eigen::VectorXd time_s = body.time_s(shared.front());
    const double period_s = MedianStep(time_s);
    for (Eigen::Index first = 0; first < rows;) {
      Eigen::Index end = first + 1;
      while (end < rows && time_s[end] - time_s[end - 1] <= kLongestStep * period_s) ++end;
      const auto piece = [&](std::size_t series) {
        return RowNumbers(shared[series].begin() + first, shared[series].begin() + end);
      };
      if (time_s[end - 1] - time_s[first] >= kShortestPiece_s) {
        StanceRecording recording;
        recording.name = name;
        recording.period_s = period_s;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          recording.joints.push_back(identify::WithRows(joints[j], piece(j + 1)));
        }
        const RowNumbers of_body = piece(0);
        recording.foot_force_N = body.foot_force_N(of_body, Eigen::all);
        recording.orientation_wxyz = body.orientation_wxyz(of_body, Eigen::all);
        recording.angular_velocity_rad_s = body.angular_velocity_rad_s(of_body, Eigen::all);
        out.push_back(std::move(recording));
      }
      first = end;
    }
  }
  if (out.empty()) {
    throw std::invalid_argument(name + ": joints, foot_force and imu share " +
                                std::to_string(rows) + " rows, expected at least " +
                                std::to_string(static_cast<int>(kShortestPiece_s)) +
                                " s without a hole");
  }
  return out;
}

std::vector<StanceRecording> ReadStance(const std::filesystem::path& path,
                                        const actuator::RobotModel& robot) {
  const recording::BodyRun body = recording::ReadBody(path);
  const std::string name = path.filename().string();
  std::vector<types::Run> joints;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    std::vector<types::Run> runs = recording::ReadRuns(path, {}, static_cast<int>(j));
    if (runs.size() != 1) {
      throw UsageError(path.string() + ": " + std::to_string(runs.size()) +
                       " sessions, expected a recording of one start of the robot");
    }
    joints.push_back(std::move(runs.front()));
  }
  try {
    return JoinRows(name, robot, std::move(joints), body);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::stance_fit
