// Why a test cannot run on this machine: its reason begins with what is missing.
//
// tools/test_summary.py reads the first word. Under SINEW_CI a skip is a failure, unless the kernel
// lacks something: packages are in the lists of tools/ and measured data lies beside the project, a
// kernel is what it is. Macros, because GTEST_SKIP returns from the function it stands in.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#define SKIP_WITHOUT_DATA(path)        \
  if (std::filesystem::exists(path)) { \
  } else                               \
    GTEST_SKIP() << "data: " << (path) \
                 << " is not here: measured data lies beside the project, in ../shared"

#define SKIP_WITHOUT_PACKAGE(available, package) \
  if (available) {                               \
  } else                                         \
    GTEST_SKIP() << "package: " << (package) << " is not installed"

#define SKIP_WITHOUT_KERNEL(available, what) \
  if (available) {                           \
  } else                                     \
    GTEST_SKIP() << "kernel: no " << (what)
