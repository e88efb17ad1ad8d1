// The planted faults of tests/mutants fit the code as it is today (tools/mutants --check).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace sinew {
namespace {

TEST(Mutants, EveryPlantedFaultStillAppliesAndHasItsTests) {
  const std::string root = SINEW_SOURCE_DIR;
  EXPECT_EQ(std::system(("'" + root + "/tools/mutants' --check >&2").c_str()), 0);
}

TEST(Mutants, TenLibrariesHaveAFaultOfEachKind) {
  namespace fs = std::filesystem;
  int libraries = 0;
  for (const fs::directory_entry& library :
       fs::directory_iterator(fs::path(SINEW_SOURCE_DIR) / "tests/mutants")) {
    if (!library.is_directory()) continue;
    ++libraries;
    for (const char* kind : {"sign", "factor", "off_by_one", "wrong_index", "missing_branch"}) {
      EXPECT_TRUE(fs::exists(library.path() / (std::string(kind) + ".patch")))
          << library.path() << " " << kind;
    }
  }
  EXPECT_GE(libraries, 10);
}

}  // namespace
}  // namespace sinew
