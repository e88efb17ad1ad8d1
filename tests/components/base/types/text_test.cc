#include "components/base/types/text.h"

#include <gtest/gtest.h>

namespace sinew::types {
namespace {

TEST(Text, IsAsLongAsTheFormatAsksFor) {
  EXPECT_EQ(Text("no %s", ""), "no ");
  EXPECT_EQ(Text("%.3g %s, %03d", 0.12345, "Nm", 7), "0.123 Nm, 007");
  const std::string word(5000, 'x');
  EXPECT_EQ(Text("%s%s", word.c_str(), word.c_str()), word + word);
}

}  // namespace
}  // namespace sinew::types
