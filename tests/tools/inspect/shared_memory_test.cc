// Stale files of Fast DDS, in folders that stand for /dev/shm and /proc.
#include "tools/inspect/shared_memory.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace sinew::inspect {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr pid_t kSelf = 500;

class SharedMemoryFiles : public ::testing::Test {
 protected:
  SharedMemoryFiles() {
    root_.Write("dev/shm/fastrtps_aaaa", std::string(3'000'000, 'x'));
    root_.Write("dev/shm/fastrtps_aaaa_el", "");
    root_.Write("dev/shm/fastrtps_port7400", "pp");
    root_.Write("dev/shm/fast_datasharing_1", "dd");
    root_.Write("dev/shm/sem.fastrtps_port7400_mutex", "s");
    root_.Write("dev/shm/of_somebody_else", "keep");
    root_.Write("proc/1/maps", "7f00 r-xp 00000000 08:01 12 /usr/lib/libc.so.6\n");
  }
  // A process that maps these files.
  void AddProcess(int id, const std::string& maps) const {
    root_.Write("proc/" + std::to_string(id) + "/maps", maps);
  }
  std::size_t FilesLeft() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(root_.path() / "dev/shm")) {
      count += entry.exists() ? 1 : 0;
    }
    return count;
  }

  testing::TemporaryFolder root_;
};

TEST_F(SharedMemoryFiles, WhatNoProcessUsesIsLeftBehind) {
  const SharedMemory memory = ReadSharedMemory(root_.path(), kSelf);
  ASSERT_EQ(memory.files.size(), 5u);
  for (const SharedFile& file : memory.files) EXPECT_FALSE(file.in_use) << file.name;
  EXPECT_THAT(memory.participants, IsEmpty());
  const Finding finding = CheckSharedMemory(memory);
  EXPECT_EQ(finding.severity, Severity::kWarning);
  EXPECT_THAT(finding.text, HasSubstr("5 of 5 files"));
  EXPECT_THAT(finding.text, HasSubstr("3.0 MB"));
  EXPECT_THAT(finding.advice, HasSubstr("--clean"));
}

TEST_F(SharedMemoryFiles, AMappedFileIsInUse) {
  AddProcess(42,
             "7f00-7f10 rw-s 00000000 00:19 5 /dev/shm/fastrtps_aaaa\n"
             "7f20-7f30 rw-s 00000000 00:19 6 /dev/shm/fast_datasharing_1 (deleted)\n");
  std::filesystem::create_directories(root_.path() / "proc/43/fd");
  AddProcess(43, "");
  std::filesystem::create_symlink("/dev/shm/fastrtps_aaaa_el", root_.path() / "proc/43/fd/5");
  const SharedMemory memory = ReadSharedMemory(root_.path(), kSelf);
  EXPECT_THAT(memory.participants, ElementsAre(42, 43));
  for (const SharedFile& file : memory.files) {
    const bool used = file.name == "fastrtps_aaaa" || file.name == "fastrtps_aaaa_el" ||
                      file.name == "fast_datasharing_1";
    EXPECT_EQ(file.in_use, used) << file.name;
  }
  EXPECT_THAT(CheckSharedMemory(memory).text, HasSubstr("2 of 5 files"));
}

TEST_F(SharedMemoryFiles, NothingIsRemovedWhileAParticipantLives) {
  // In real time a participant uses no shared memory, but it has the library loaded.
  AddProcess(42, "7f00 r-xp 00000000 08:01 99 /usr/lib/x86_64-linux-gnu/libfastrtps.so.2.9.1\n");
  const Finding finding = CleanSharedMemory(root_.path(), kSelf);
  EXPECT_EQ(finding.severity, Severity::kFault);
  EXPECT_THAT(finding.text, HasSubstr("nothing was removed: process 42"));
  EXPECT_EQ(FilesLeft(), 6u);
}

TEST_F(SharedMemoryFiles, TheDoctorItselfIsNoParticipant) {
  AddProcess(kSelf, "7f00 r-xp 00000000 08:01 99 /usr/lib/libfastrtps.so.2.9\n");
  EXPECT_THAT(ReadSharedMemory(root_.path(), kSelf).participants, IsEmpty());
}

TEST_F(SharedMemoryFiles, NothingIsRemovedWhileSomebodyHoldsALock) {
  const std::string path = (root_.path() / "dev/shm/fastrtps_aaaa_el").string();
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  ASSERT_EQ(::flock(descriptor, LOCK_EX), 0);
  const Finding finding = CleanSharedMemory(root_.path(), kSelf);
  EXPECT_EQ(finding.severity, Severity::kFault);
  EXPECT_THAT(finding.text, HasSubstr("fastrtps_aaaa_el is locked"));
  EXPECT_EQ(FilesLeft(), 6u);
  ::close(descriptor);
}

TEST_F(SharedMemoryFiles, WithoutAParticipantAllOfFastDdsAndNothingElseIsRemoved) {
  const Finding finding = CleanSharedMemory(root_.path(), kSelf);
  EXPECT_EQ(finding.severity, Severity::kOk) << finding.text;
  EXPECT_THAT(finding.text, HasSubstr("5 files"));
  EXPECT_EQ(FilesLeft(), 1u);
  EXPECT_TRUE(std::filesystem::exists(root_.path() / "dev/shm/of_somebody_else"));
  EXPECT_EQ(CheckSharedMemory(ReadSharedMemory(root_.path(), kSelf)).severity, Severity::kOk);
}

TEST_F(SharedMemoryFiles, AProcessThatCannotBeLookedIntoMayBeAParticipant) {
  std::filesystem::create_directories(root_.path() / "proc/77");  // without maps
  const SharedMemory memory = ReadSharedMemory(root_.path(), kSelf);
  EXPECT_THAT(memory.unreadable, ElementsAre(77));
  EXPECT_EQ(CheckSharedMemory(memory).severity, Severity::kNote);
  EXPECT_EQ(CleanSharedMemory(root_.path(), kSelf).severity, Severity::kFault);
  EXPECT_EQ(FilesLeft(), 6u);
}

TEST(SharedMemory, AMissingFolderIsAFault) {
  const testing::TemporaryFolder root;
  EXPECT_EQ(CheckSharedMemory(ReadSharedMemory(root.path(), kSelf)).severity, Severity::kFault);
}

}  // namespace
}  // namespace sinew::inspect
