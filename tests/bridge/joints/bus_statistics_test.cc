// Load, answer times and work per cycle against numbers counted by hand.
#include "bridge/joints/bus_statistics.h"

#include <gtest/gtest.h>

namespace sinew::bridge {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(RequestTimer, TimesTheFirstAnswerAfterTheRequest) {
  RequestTimer timer;
  EXPECT_FALSE(timer.Stop(5'000)) << "nothing was asked";
  timer.Start(10'000);
  EXPECT_FALSE(timer.Stop(9'999)) << "from before the request";
  ASSERT_TRUE(timer.Stop(12'500));
  EXPECT_FALSE(timer.Stop(13'000)) << "answered already";
  timer.Start(20'000);
  timer.Start(30'000);
  EXPECT_EQ(timer.Stop(31'000), 1.0) << "of the last request, us";
}

TEST(RecentTimes, MedianAndLargestSinceTheLastSummary) {
  RecentTimes times;
  EXPECT_EQ(times.Summarize().largest_us, 0.0);
  for (const double value : {5.0, 1.0, 9.0, 3.0, 7.0}) times.Add(value);
  const RecentTimes::Summary summary = times.Summarize();
  EXPECT_EQ(summary.median_us, 5.0);
  EXPECT_EQ(summary.largest_us, 9.0);
  EXPECT_EQ(times.Summarize().median_us, 0.0) << "begun anew";
  times.Add(2.0);
  EXPECT_EQ(times.Summarize().largest_us, 2.0);
}

TEST(RecentTimes, KeepsTheNewest512) {
  RecentTimes times;
  times.Add(1e6);
  for (int i = 0; i < 512; ++i) times.Add(i);
  const RecentTimes::Summary summary = times.Summarize();
  EXPECT_EQ(summary.largest_us, 511.0);
  EXPECT_EQ(summary.median_us, 256.0);
}

BusSample Sample(can::Link link, std::uint64_t wire_bits) {
  BusSample sample;
  sample.link = link;
  sample.counters = {11, 12, 13, 14, 15, wire_bits};
  sample.body = {16, 17};
  return sample;
}

TEST(BusStatistics, LinkAndCountersAreOfNow) {
  BusStatistics statistics({1e6, 1e6, 1e6, 1e6});
  const BusSample samples[] = {Sample(can::Link::kUp, 0), Sample(can::Link::kPassive, 0),
                               Sample(can::Link::kBusOff, 0), Sample(can::Link::kDown, 0)};
  statistics.Update(samples, 10.0, 1);
  const provider::BusReport& report = statistics.report();
  EXPECT_EQ(report.bus_count, 4);
  EXPECT_TRUE(report.up[0]);
  EXPECT_TRUE(report.up[1]) << "error-passive still carries frames";
  EXPECT_FALSE(report.up[2]);
  EXPECT_FALSE(report.up[3]);
  EXPECT_EQ(report.frames_sent[3], 11U);
  EXPECT_EQ(report.frames_received[3], 12U);
  EXPECT_EQ(report.frames_dropped[3], 13U);
  EXPECT_EQ(report.frames_lost[3], 14U);
  EXPECT_EQ(report.error_frames[3], 15U);
  EXPECT_EQ(report.body_samples_missed[3], 16U);
  EXPECT_EQ(report.body_nodes_lost[3], 17U);
}

TEST(BusStatistics, LoadAnswersAndWorkAreOfTheLastSecond) {
  BusStatistics statistics({1e6, 5e5});
  statistics.Start(100);
  statistics.AddAnswer(1, 700.0);
  statistics.AddAnswer(1, 900.0);
  const auto update = [&](std::uint64_t bits, double work_us, std::int64_t now_ns) {
    const BusSample samples[] = {Sample(can::Link::kUp, bits), Sample(can::Link::kUp, bits)};
    statistics.Update(samples, work_us, now_ns);
  };
  update(100'000, 20.0, 100 + kSecond_ns - 1);
  EXPECT_EQ(statistics.report().load_percent[0], 0.0) << "the second is not over";
  update(250'000, 40.0, 100 + kSecond_ns);
  const provider::BusReport& report = statistics.report();
  EXPECT_DOUBLE_EQ(report.load_percent[0], 25.0);
  EXPECT_DOUBLE_EQ(report.load_percent[1], 50.0);
  EXPECT_EQ(report.answer_p50_us[0], 0.0) << "no answer there";
  EXPECT_EQ(report.answer_p50_us[1], 900.0);
  EXPECT_EQ(report.answer_max_us[1], 900.0);
  EXPECT_EQ(report.cycle_p50_us, 40.0);
  EXPECT_EQ(report.cycle_max_us, 40.0);
  update(350'000, 5.0, 100 + 3 * kSecond_ns);  // two seconds later
  EXPECT_DOUBLE_EQ(report.load_percent[0], 5.0);
  EXPECT_EQ(report.answer_max_us[1], 0.0);
  EXPECT_EQ(report.cycle_max_us, 5.0);
}

}  // namespace
}  // namespace sinew::bridge
