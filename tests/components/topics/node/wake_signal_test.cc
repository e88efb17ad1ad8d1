#include "components/topics/node/wake_signal.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace sinew::node::internal {
namespace {

using namespace std::chrono_literals;

const int kTrigger = 0, kReference = 0, kOther = 0;

TEST(WakeSignal, NewsOfEverySourceSinceTheLastWaitCompletesAWait) {
  WakeSignal signal;
  const std::array<const void*, 2> both = {&kTrigger, &kReference};
  signal.Notify(&kReference);
  signal.Notify(&kOther);
  EXPECT_FALSE(signal.Wait(1ms, both)) << "nothing of the trigger";
  signal.Notify(&kTrigger);
  EXPECT_FALSE(signal.Wait(1ms, both)) << "what was before the last wait does not count";
  signal.Notify(&kReference);
  signal.Notify(&kTrigger);
  EXPECT_TRUE(signal.Wait(1h, both));
}

TEST(WakeSignal, WithoutSourcesAnyNewsWill) {
  WakeSignal signal;
  EXPECT_FALSE(signal.Wait(1ms));
  signal.Notify(&kOther);
  EXPECT_TRUE(signal.Wait(1h));
}

TEST(WakeSignal, NullEndsEveryWait) {
  WakeSignal signal;
  const std::array<const void*, 1> one = {&kTrigger};
  signal.Notify(nullptr);
  EXPECT_TRUE(signal.Wait(1h, one));
}

TEST(WakeSignal, AnotherThreadEndsTheWaitWithTheLastSource) {
  WakeSignal signal;
  const std::array<const void*, 2> both = {&kTrigger, &kReference};
  std::thread other([&] {
    signal.Notify(&kTrigger);
    signal.Notify(&kReference);
  });
  EXPECT_TRUE(signal.Wait(1h, both));
  other.join();
}

}  // namespace
}  // namespace sinew::node::internal
