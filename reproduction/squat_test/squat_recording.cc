#include "reproduction/squat_test/squat_recording.h"

#include <sinew_idl/joint.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/simulation.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>

#include "components/base/config/config.h"
#include "components/base/types/angle.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"

namespace sinew::squat_test {
namespace {

constexpr double kFallenTilt_rad = std::numbers::pi / 6.0;
constexpr double kFallenHeightShare = 0.8;

struct Tick {
  std::optional<msg::JointState> state;
  std::optional<msg::Reference> reference;
  std::optional<msg::SimBodyTruth> truth;
};

template <class Message>
void Take(const node::Bytes& bytes, std::map<std::uint64_t, Tick>* ticks,
          std::optional<Message> Tick::*member) {
  Message message;
  if (!node::Decode(bytes, &message)) return;
  const std::uint64_t tick = message.header.tick;
  (*ticks)[tick].*member = std::move(message);
}

std::map<std::uint64_t, Tick> ReadTicks(const std::filesystem::path& file) {
  std::map<std::uint64_t, Tick> ticks;
  const std::string_view state = node::kJointState.name, reference = node::kReference.name,
                         truth = node::kSimBodyTruth.name;
  try {
    recording::FileSource source(file);
    const recording::McapReader reader(source);
    recording::MessageFilter filter;
    filter.topics = {std::string(state), std::string(reference), std::string(truth)};
    recording::McapMessages messages = reader.Messages(filter);
    recording::McapMessage message;
    while (messages.Next(&message)) {
      const std::string& topic = reader.channels().at(message.channel_id).topic;
      const node::Bytes bytes(message.data.begin(), message.data.end());
      if (topic == state) Take<msg::JointState>(bytes, &ticks, &Tick::state);
      if (topic == reference) Take<msg::Reference>(bytes, &ticks, &Tick::reference);
      if (topic == truth) Take<msg::SimBodyTruth>(bytes, &ticks, &Tick::truth);
    }
  } catch (const recording::McapError& error) {
    throw UsageError(file.string() + ": " + error.what());
  }
  return ticks;
}

}  // namespace

SquatRecording ReadSquats(const std::filesystem::path& file) {
  SquatRecording squats;
  for (const auto& [number, tick] : ReadTicks(file)) {
    if (!tick.state || !tick.reference || !tick.truth) continue;
    if (squats.time_s.empty()) {
      squats.period_s = tick.state->period_s;
      squats.joints = static_cast<int>(tick.state->joint_count);
    }
    squats.time_s.push_back(static_cast<double>(number) * squats.period_s);
    types::JointArray<double> reference{}, position{};
    for (std::size_t j = 0; j < static_cast<std::size_t>(squats.joints); ++j) {
      reference[j] = tick.reference->position_rad[j];
      position[j] = tick.state->position_rad[j];
    }
    squats.reference_rad.push_back(reference);
    squats.position_rad.push_back(position);
    squats.height_m.push_back(tick.truth->position_m[2]);
    squats.tilt_rad.push_back(types::Tilt(tick.truth->orientation_wxyz));
  }
  if (squats.time_s.empty()) {
    throw UsageError(file.string() +
                     ": no tick with joint_state, reference and sim_body_truth, expected squats in "
                     "sinew-world");
  }
  return squats;
}

double MeanSquareError(const SquatRecording& recording, double begin_s, double end_s) {
  if (recording.time_s.back() < end_s - 1.5 * recording.period_s) {
    throw std::invalid_argument("the recording ends at " + std::to_string(recording.time_s.back()) +
                                " s, expected " + std::to_string(end_s) + " s");
  }
  double sum = 0.0;
  long count = 0;
  for (std::size_t k = 0; k < recording.time_s.size(); ++k) {
    if (recording.time_s[k] < begin_s || recording.time_s[k] >= end_s) continue;
    for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
      const double error = recording.reference_rad[k][j] - recording.position_rad[k][j];
      sum += error * error;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

std::optional<double> FallTime(const SquatRecording& recording, double depth_m) {
  const double lowest_m = recording.height_m.front() - depth_m;
  for (std::size_t k = 0; k < recording.time_s.size(); ++k) {
    if (recording.tilt_rad[k] > kFallenTilt_rad ||
        recording.height_m[k] < kFallenHeightShare * lowest_m) {
      return recording.time_s[k];
    }
  }
  return std::nullopt;
}

std::vector<double> SlidingError(const SquatRecording& recording, double window_s) {
  const auto window = static_cast<std::size_t>(std::lround(window_s / recording.period_s));
  std::vector<double> squares, sliding;
  double sum = 0.0;
  for (std::size_t k = 0; k < recording.time_s.size(); ++k) {
    double square = 0.0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
      const double error = recording.reference_rad[k][j] - recording.position_rad[k][j];
      square += error * error / recording.joints;
    }
    squares.push_back(square);
    sum += square;
    if (k >= window) sum -= squares[k - window];
    sliding.push_back(std::sqrt(std::max(0.0, sum) / static_cast<double>(std::min(k + 1, window))));
  }
  return sliding;
}

}  // namespace sinew::squat_test
