// Writes the seeds of every harness as files, for libFuzzer: DIR/codec/0000 and so on.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/harness.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds DIR\n");
    return 2;
  }
  for (const auto& harness : sinew::fuzz::kHarnesses) {
    const auto folder = std::filesystem::path(argv[1]) / harness.name;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const auto& seed : harness.seeds()) {
      char name[16];
      std::snprintf(name, sizeof name, "%04d", number++);
      std::ofstream file(folder / name, std::ios::binary);
      file.write(reinterpret_cast<const char*>(seed.data()),
                 static_cast<std::streamsize>(seed.size()));
      if (!file.flush()) {
        std::fprintf(stderr, "cannot write %s\n", (folder / name).c_str());
        return 1;
      }
    }
  }
}
