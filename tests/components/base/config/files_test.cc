// Files of a user: what is replaced, what is written directly, what is read, and how much of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <set>
#include <string>

#include "components/base/config/config.h"
#include "components/base/config/unix_socket.h"
#include "components/base/config/whole_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::config {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Files : public ::testing::Test {
 protected:
  template <class Call>
  static std::string ErrorOf(Call call) {
    try {
      call();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  }
  std::size_t EntriesInFolder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }

  const testing::TemporaryFolder folder_;
  const fs::path file_ = folder_.path() / "out";
};

// A pipe with text in it and no writer: what `<(...)` of a shell is.
class Pipe {
 public:
  explicit Pipe(const std::string& text) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  ~Pipe() {
    ::close(ends_[0]);
    if (!ended_) ::close(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void End() { ended_ = ::close(ends_[1]) == 0; }
  std::string Take() {
    std::array<char, 64> text{};
    const ssize_t got = ::read(ends_[0], text.data(), text.size());
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
  }
  fs::path path(int end) const {
    return "/proc/self/fd/" + std::to_string(ends_[static_cast<std::size_t>(end)]);
  }

 private:
  std::array<int, 2> ends_{};
  bool ended_ = false;
};

TEST_F(Files, ALinkToAFileStaysALink) {
  fs::create_symlink("target", file_);
  folder_.Write("target", "old");
  WriteFileAtomically(file_, "new");
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_EQ(ReadFile(folder_.path() / "target"), "new");
  EXPECT_EQ(EntriesInFolder(), 2u);
}

TEST_F(Files, DevicesAndPipesAreWrittenDirectly) {
  fs::create_symlink("/dev/null", file_);
  WriteFileAtomically(file_, "text");
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_TRUE(fs::is_character_file(file_));
  Pipe pipe("");
  WriteFileAtomically(pipe.path(1), "text");
  EXPECT_EQ(pipe.Take(), "text");
}

TEST_F(Files, FoldersAndSocketsAreNotReplaced) {
  EXPECT_EQ(ErrorOf([&] { WriteFileAtomically(folder_.path(), "text"); }),
            folder_.path().string() + ": is a folder, expected the name of a file");
  ASSERT_EQ(::mknod(file_.c_str(), S_IFSOCK | 0600, 0), 0);
  EXPECT_EQ(ErrorOf([&] { WriteFileAtomically(file_, "text"); }),
            file_.string() + ": is a socket, expected the name of a file");
  EXPECT_TRUE(fs::is_socket(file_));
}

TEST_F(Files, NobodyCanGuessWhereAFileIsWrittenFirst) {
  std::set<fs::path> names;
  for (int i = 0; i < 10; ++i) names.insert(PartPath(file_));
  EXPECT_EQ(names.size(), 10u);
  {
    const WholeFile file(file_);
    EXPECT_THAT(fs::read_symlink(file.DescriptorPath()).string(),
                StartsWith(file_.string() + ".part."));
  }
  EXPECT_EQ(EntriesInFolder(), 0u) << "without a Commit nothing stays";
}

TEST_F(Files, APipeIsReadToItsEndAndADeviceNotAtAll) {
  Pipe pipe("text");
  pipe.End();
  EXPECT_EQ(ReadFile(pipe.path(0)), "text");
  EXPECT_EQ(ErrorOf([] { ReadFile("/dev/zero"); }), "/dev/zero: is a device, expected a file");
}

TEST_F(Files, ReadingStopsAtALimit) {
  folder_.Write("out", "12345");
  EXPECT_EQ(ReadFile(file_, 5), "12345");
  EXPECT_EQ(ErrorOf([&] { ReadFile(file_, 4); }),
            file_.string() + ": has more than 4 bytes, expected a smaller file");
  fs::resize_file(file_, kLargestText + 1);
  EXPECT_THAT(ErrorOf([&] { ReadFile(file_); }), HasSubstr("has more than 16777216 bytes"));
}

TEST_F(Files, APrivateSocketIsInAFolderThatIsItsUsersAlone) {
  const char* const before = std::getenv("XDG_RUNTIME_DIR");
  const std::string kept = before == nullptr ? "" : before;
  ASSERT_EQ(::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1), 0);
  EXPECT_EQ(PrivateSocket("a.sock"), folder_.path() / "a.sock");
  const fs::path own = "/tmp/sinew-" + std::to_string(::geteuid());
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0777), 0);
  EXPECT_EQ(PrivateSocket("a.sock"), own / "a.sock") << "others may write to the first";
  struct stat status {};
  ASSERT_EQ(::lstat(own.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & (S_IFMT | S_IWGRP | S_IWOTH), static_cast<mode_t>(S_IFDIR));
  EXPECT_EQ(status.st_uid, ::geteuid());
  if (::geteuid() == 0) {
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0700), 0);
    ASSERT_EQ(::chown(folder_.path().c_str(), 65534, static_cast<gid_t>(-1)), 0);
    EXPECT_EQ(PrivateSocket("a.sock"), own / "a.sock") << "the first is another user's";
  }
  ::unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(PrivateSocket("a.sock"), own / "a.sock");
  if (!kept.empty()) ::setenv("XDG_RUNTIME_DIR", kept.c_str(), 1);
}

}  // namespace
}  // namespace sinew::config
