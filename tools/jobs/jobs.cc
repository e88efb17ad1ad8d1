#include "tools/jobs/jobs.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace sinew::tools {

void RunJobs(const std::vector<std::function<void()>>& jobs, int threads,
             const std::function<void(std::size_t)>& progress) {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0, done = 0;
  int running = std::max(1, threads);
  std::exception_ptr failure;
  const auto work = [&] {
    std::unique_lock lock(mutex);
    while (next < jobs.size() && !failure) {
      const std::size_t job = next++;
      lock.unlock();
      std::exception_ptr mine;
      try {
        jobs[job]();
      } catch (...) {
        mine = std::current_exception();
      }
      lock.lock();
      if (mine && !failure) failure = mine;
      ++done;
    }
    --running;
    changed.notify_all();
  };
  std::vector<std::jthread> workers;
  const int count = running;
  workers.reserve(static_cast<std::size_t>(count));
  for (int t = 0; t < count; ++t) workers.emplace_back(work);
  std::unique_lock lock(mutex);
  while (running > 0) {
    changed.wait_for(lock, std::chrono::milliseconds(100));
    const std::size_t now = done;
    lock.unlock();
    if (progress) progress(now);
    lock.lock();
  }
  lock.unlock();
  workers.clear();
  if (progress) progress(done);  // the workers may have ended before anyone waited for them
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sinew::tools
