#include "tools/inspect/message_text.h"

#include <gtest/gtest.h>

#include "tests/support/json_cdr.h"

namespace sinew::inspect {
namespace {

constexpr char kIdl[] =
    "module m {\n"
    "@final struct Part { octet joint_count; double angle_rad[12]; };\n"
    "@final struct Whole { octet joint_count; double position_rad[12]; boolean valid[12];\n"
    "  double other[3]; sequence<Part, 4> part; string<8> text; };\n"
    "};\n";

nlohmann::ordered_json Shown(const nlohmann::ordered_json& message) {
  const recording::IdlSchema idl = recording::IdlSchema::Parse(kIdl);
  const recording::IdlType& type = idl.Struct("m::Whole");
  return MessageJson(type, recording::JsonToCdr(type, message));
}

TEST(MessageText, OfJointArraysOnlyTheUsedEntriesAreShown) {
  const auto json = Shown({{"joint_count", 2}, {"position_rad", {0.5, -1.5, 7.0}}});
  EXPECT_EQ(json["position_rad"], nlohmann::ordered_json({0.5, -1.5}));
  EXPECT_EQ(json["valid"].size(), 2u);
  EXPECT_EQ(json["other"].size(), 3u) << "no array of joints";
}

TEST(MessageText, NestedStructsHaveTheirOwnCount) {
  const auto json =
      Shown({{"joint_count", 1}, {"part", {{{"joint_count", 3}}, {{"joint_count", 0}}}}});
  EXPECT_EQ(json["part"][0]["angle_rad"].size(), 3u);
  EXPECT_EQ(json["part"][1]["angle_rad"].size(), 0u);
}

TEST(MessageText, ACountBeyondTheArraysHidesNothing) {
  EXPECT_EQ(Shown({{"joint_count", 200}})["position_rad"].size(), 12u);
}

}  // namespace
}  // namespace sinew::inspect
