#include "components/base/types/median.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace sinew::types {
namespace {

TEST(UpperMedian, IsTheMiddleValueAndTheUpperOneOfTwo) {
  EXPECT_EQ(UpperMedian(std::vector<double>{7.0}), 7.0);
  EXPECT_EQ(UpperMedian(std::vector<double>{9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(UpperMedian(std::vector<std::int64_t>{4, 1, 3, 2}), 3);
}

}  // namespace
}  // namespace sinew::types
