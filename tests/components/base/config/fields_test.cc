// One description reads a section and becomes a schema.
#include "components/base/config/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::config {

enum class Kind { kRound, kLong };
struct Part {
  double length_m = 0.5;
};
struct Thing {
  Kind kind = Kind::kRound;
  double radius_rad = 0.1, reach_m = 0.2;
  int count = 3;
  std::optional<double> mass_kg;
  std::vector<Part> parts;
  std::array<double, 3> place_m{};
};

void Describe(Fields& f, Part& c) { f.Need("length_m", c.length_m, kPositive, "of it"); }

void Describe(Fields& f, Thing& c) {
  bool linear = false;
  f.Word("joint", linear, {{"rotary", false}, {"linear", true}}, "units");
  f.set_linear(linear);
  const auto kind =
      f.NeedWord("kind", c.kind, {{"round", Kind::kRound}, {"long", Kind::kLong}}, "form");
  if (const auto round = kind.Is({"round"})) f("~radius_rad", c.radius_rad, kPositive, "size");
  if (const auto is_long = kind.Is({"long"})) f.Need("reach_m", c.reach_m, "size");
  f("count", c.count, {1, 5}, "how many");
  f("mass_kg", c.mass_kg, "left out: none");
  f("parts", c.parts, {0, 2}, "of the thing");
  f("place_m", c.place_m, "where");
  f.Require(c.count != 4, "count", "is 4, expected another");
  f.Check("kind", [&] {
    if (c.reach_m < 0.0) throw std::invalid_argument("reach is below 0");
  });
}

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Thing Parse(const std::string& text) {
  return Read<Thing>(Section::Parse("schema: thing/1\n" + text, "thing.yaml", "thing/1"));
}

std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(Parse(text));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Fields, ReadWhatIsThereAndLeaveTheRest) {
  const Thing thing = Parse("kind: long\nreach_m: 2\nparts: [{length_m: 3}]\nplace_m: [1, 2, 3]\n");
  EXPECT_EQ(thing.kind, Kind::kLong);
  EXPECT_EQ(thing.reach_m, 2.0);
  EXPECT_EQ(thing.count, 3);
  EXPECT_FALSE(thing.mass_kg);
  EXPECT_EQ(thing.parts.at(0).length_m, 3.0);
  EXPECT_EQ(thing.place_m[2], 3.0);
  EXPECT_EQ(Parse("kind: round\njoint: linear\nradius_m: 3\n").radius_rad, 3.0);
}

TEST(Fields, AnErrorNamesFileLineAndKey) {
  EXPECT_EQ(ErrorOf("count: 3\n"),
            "thing.yaml:1: key 'kind': missing, expected one of round, long");
  EXPECT_EQ(ErrorOf("kind: round\ncount: 6\n"),
            "thing.yaml:3: key 'count': '6', expected a number from 1 to 5");
  EXPECT_THAT(ErrorOf("kind: round\nreach_m: 1\n"), HasSubstr("key 'reach_m': unknown"));
  EXPECT_THAT(ErrorOf("kind: round\nradius_m: 1\n"), HasSubstr("expected 'radius_rad'"));
  EXPECT_THAT(ErrorOf("kind: long\n"), HasSubstr("key 'reach_m': missing"));
  EXPECT_THAT(ErrorOf("kind: round\nparts: [{length_m: 1}, {}]\n"), HasSubstr("parts[1].length_m"));
  EXPECT_THAT(ErrorOf("kind: round\nparts: [{}, {}, {}]\n"), HasSubstr("has 3 entries"));
  EXPECT_THAT(ErrorOf("kind: round\nplace_m: [1, 2]\n"), HasSubstr("expected x, y, z"));
  EXPECT_THAT(ErrorOf("kind: round\ncount: 4\n"), HasSubstr("'count': is 4"));
  EXPECT_THAT(ErrorOf("kind: long\nreach_m: -1\n"), HasSubstr("'kind': reach is below 0"));
  // A mistyped key is not taken for its default.
  EXPECT_THAT(ErrorOf("kind: long\nreach_m: -1\ncuont: 4\n"), HasSubstr("key 'cuont'"));
}

TEST(Fields, DescribeEveryKeyWithItsDefaultAndCase) {
  const auto shape = std::make_shared<Shape>();
  Fields fields(shape);
  Thing thing;
  Describe(fields, thing);
  ASSERT_EQ(shape->fields.size(), 8u);
  const FieldInfo& radius = shape->fields[2];
  EXPECT_THAT(radius.keys, ElementsAre("radius_rad", "radius_m"));
  EXPECT_EQ(radius.fallback, "0.1");
  ASSERT_EQ(radius.when.size(), 1u);
  EXPECT_THAT(radius.when[0].words, ElementsAre("round"));
  EXPECT_TRUE(shape->fields[3].needed);
  EXPECT_EQ(shape->fields[4].type, "integer");
  EXPECT_EQ(shape->fields[5].fallback, "");
  EXPECT_EQ(shape->fields[6].count.upper, 2.0);
  EXPECT_EQ(shape->fields[6].entries->fields[0].keys[0], "length_m");
  EXPECT_TRUE(shape->open.empty());
}

}  // namespace
}  // namespace sinew::config
