#include "tools/jobs/jobs.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <vector>

namespace sinew::tools {
namespace {

TEST(Jobs, EveryOneRunsOnceAndAFailureIsThrown) {
  std::vector<int> count(50, 0);
  std::vector<std::function<void()>> jobs;
  for (int& c : count) jobs.push_back([&c] { ++c; });
  std::size_t last = 0;
  RunJobs(jobs, 2, [&](std::size_t done) { last = done; });
  for (const int c : count) EXPECT_EQ(c, 1);
  EXPECT_EQ(last, 50U);
  jobs.push_back([] { throw std::invalid_argument("this one"); });
  EXPECT_THROW(RunJobs(jobs, 2), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tools
