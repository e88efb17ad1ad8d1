// A program with another wall clock (Debian's libfaketime); its timers are left alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sinew::testing {

// Empty: not installed.
inline std::string FakeTimeLibrary() {
  for (const auto& folder : std::filesystem::directory_iterator("/usr/lib")) {
    const std::filesystem::path library = folder.path() / "faketime/libfaketimeMT.so.1";
    if (std::filesystem::exists(library)) return library;
  }
  return {};
}

// In front of a command line. shift: "+2", "-3600", in seconds.
inline std::vector<std::string> WithClock(const std::string& shift) {
  return {"env", "LD_PRELOAD=" + FakeTimeLibrary(), "FAKETIME=" + shift,
          "FAKETIME_DONT_FAKE_MONOTONIC=1"};
}

}  // namespace sinew::testing
