// The program sinew-world: one line and exit code 2 for what a user got wrong, 0 for a session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

using ::testing::HasSubstr;

struct Result {
  int exit_code = -1;
  std::string output;
};

Result Call(const std::string& arguments) {
  const std::string command =
      SINEW_BIN_DIR "/sinew-world --domain 50 --log-level error " + arguments + " 2>&1";
  Result result;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 512> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) result.output += buffer.data();
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

void ExpectUsageError(const std::string& arguments, const std::string& expected) {
  const Result result = Call(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << result.output;
  EXPECT_THAT(result.output, HasSubstr(expected));
}

const std::string kRig = SINEW_SOURCE_DIR "/robots/rig/world.yaml";
const std::string kEmps = SINEW_SOURCE_DIR "/robots/emps/world.yaml";
const std::string kBiped = SINEW_SOURCE_DIR "/robots/biped/world.yaml";  // on a floating base

TEST(SinewWorld, RunsASessionInLockstep) {
  for (const std::string& config : {kRig, kEmps, kBiped}) {
    const Result result = Call("--config " + config + " --lockstep --duration 0.5");
    EXPECT_EQ(result.exit_code, 0) << result.output;
  }
}

TEST(SinewWorld, WritesAVideoOfItsSession) {
  const std::filesystem::path video = std::filesystem::temp_directory_path() /
                                      ("sinew_world_view_" + std::to_string(::getpid()) + ".mp4");
  const Result result =
      Call("--config " + kRig + " --lockstep --duration 0.2 --view " + video.string());
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_TRUE(std::filesystem::exists(video));
  std::filesystem::remove(video);
}

TEST(SinewWorld, ReportsBadInputInOneLineAndExitsWithTwo) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("sinew_world_bad_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string urdf = folder / "bad.urdf";
  std::ofstream(urdf) << "<robot name='r'>\n<link name='a'>\n</robot>\n";
  ExpectUsageError("", "--config");
  ExpectUsageError("--config /no/such/file.yaml", "/no/such/file.yaml");
  ExpectUsageError("--config " + kRig + " --view rig.avi", "expected a name that ends in .mp4");
  ExpectUsageError("--config " + kRig + " --urdf " + urdf, "bad.urdf:3: no valid XML");
  ExpectUsageError("--config " + kRig + " --model " SINEW_SOURCE_DIR "/robots/emps/model.yaml",
                   "world.yaml:9");
  ExpectUsageError("--config " + std::string(SINEW_SOURCE_DIR "/robots/rig/model.yaml"),
                   "expected 'sinew-world/1'");
  std::filesystem::remove_all(folder);
}

}  // namespace
