// Several contract tests at a time, each in a domain of its own: they wait more than they compute.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tools/conform/conform.h"

namespace sinew::conform {

// A report for each of the options, whose domain is replaced by one of `domains`. What is not right
// is run again, twice at most: another program's load is none of the rules. Throws what a test
// threw.
inline std::vector<Report> RunAll(const std::vector<Options>& all, const std::vector<int>& domains,
                                  const std::function<bool(std::size_t, const Report&)>& is_right) {
  constexpr int kRuns = 3;
  std::vector<Report> reports(all.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;  // guarded by mutex
  std::vector<std::thread> workers;
  for (const int domain : domains) {
    workers.emplace_back([&, domain] {
      for (std::size_t i = next++; i < all.size(); i = next++) {
        try {
          Options options = all[i];
          options.domain_id = domain;
          for (int run = 0; run < kRuns; ++run) {
            reports[i] = RunConform(options);
            if (is_right(i, reports[i])) break;
          }
        } catch (...) {
          const std::lock_guard lock(mutex);
          error = std::current_exception();
        }
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  if (error) std::rethrow_exception(error);
  return reports;
}

}  // namespace sinew::conform
