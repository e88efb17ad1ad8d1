#include "components/record/recording/idl_schema.h"

#include <gtest/gtest.h>

#include "components/record/recording/cdr.h"
#include "components/topics/node/topics.h"

namespace sinew::recording {
namespace {

using Kind = IdlType::Kind;

std::string ErrorOf(std::string_view text) {
  try {
    IdlSchema::Parse(text);
  } catch (const IdlError& error) {
    return error.what();
  }
  return "";
}

TEST(IdlSchema, ReadsEveryConstructOfOurSubset) {
  const IdlSchema schema = IdlSchema::Parse(R"(
    // a comment with struct { in it
    module a { module b {
    enum Color { RED, /* middle */ GREEN, BLUE };
    @final
    struct Point { double x_m, y_m; };
    @final struct All {
      @key string<64> name;
      boolean flag; octet byte; char letter; short s; unsigned short us; long l; unsigned long ul;
      long long ll; unsigned long long ull; float f; double d[12];
      Color color; a::b::Point point; b::Point points[2];
      sequence<double, 640> list; sequence<Point> path; string free;
      int32 i32; uint64 u64;
    };
    }; };)");
  ASSERT_EQ(schema.types().size(), 3u);
  const IdlType& all = schema.Struct("a::b::All");
  EXPECT_EQ(all.members.size(), 20u);
  EXPECT_TRUE(all.members[0].key);
  EXPECT_EQ(all.members[0].type->bound, 64u);
  EXPECT_EQ(all.members[6].type->kind, Kind::kInt32);
  EXPECT_EQ(all.members[9].type->kind, Kind::kUint64);
  EXPECT_EQ(all.members[11].type->kind, Kind::kArray);
  EXPECT_EQ(all.members[11].type->bound, 12u);
  EXPECT_EQ(all.members[12].type->enumerators[1], "GREEN");
  EXPECT_EQ(all.members[13].type->name, "a::b::Point");
  EXPECT_EQ(all.members[15].type->bound, 640u);
  EXPECT_EQ(KeyFields(all), std::vector<std::string>{"name"});
}

TEST(IdlSchema, ReadsTheTextOfEveryTopic) {
  ASSERT_FALSE(node::AllTopics().empty());
  for (const node::TopicInfo& topic : node::AllTopics()) {
    const IdlSchema schema = IdlSchema::Parse(topic.idl);
    const IdlType& type = schema.Struct(topic.type_name);
    EXPECT_TRUE(HasField(type, "header.tick")) << topic.name;
    EXPECT_TRUE(HasField(type, "header.origin")) << topic.name;
    EXPECT_EQ(KeyFields(type).empty(), topic.name != "component_status") << topic.name;
  }
}

TEST(IdlSchema, SaysLineAndWhatWasExpected) {
  EXPECT_EQ(ErrorOf("struct A {\n  double x\n};"), "line 3: found '}', expected ';'");
  EXPECT_EQ(ErrorOf("struct A { Nothing x; };"), "line 1: type 'Nothing' is not known here");
  EXPECT_EQ(ErrorOf("struct A { @optional double x; };"),
            "line 1: annotation @optional changes the encoding, expected @final and @key only");
  EXPECT_EQ(ErrorOf("struct A { double x[2][2]; };"),
            "line 1: member 'x' has two dimensions, expected one");
  EXPECT_EQ(ErrorOf("struct A { double x; double x; };"), "line 1: member 'x' is there twice");
  EXPECT_EQ(ErrorOf("union A { };"), "line 1: found 'union', expected module, struct or enum");
  EXPECT_NE(ErrorOf("struct A : B { double x; };"), "");
  EXPECT_NE(ErrorOf("struct A { long double x; };"), "");
  EXPECT_NE(ErrorOf("struct A { wstring x; };"), "");
  EXPECT_NE(ErrorOf("struct A { double x[0]; };"), "");
  EXPECT_NE(ErrorOf("struct A { double x[n]; };"), "");
  EXPECT_NE(ErrorOf("struct A { };"), "");
  EXPECT_NE(ErrorOf("module a {"), "");
  EXPECT_NE(ErrorOf("struct A { double x; }; struct A { double x; };"), "");
}

TEST(IdlSchema, NeverCrashesOnCutOrNestedText) {
  const std::string text = node::FindTopic("component_status")->idl;
  for (std::size_t length = 0; length < text.size(); ++length) {
    (void)ErrorOf(std::string_view(text).substr(0, length));
  }
  std::string deep = "struct A { ";
  for (int i = 0; i < 100000; ++i) deep += "sequence<";
  EXPECT_NE(ErrorOf(deep), "");
  deep.clear();
  for (int i = 0; i < 100000; ++i) deep += "module a { ";
  EXPECT_NE(ErrorOf(deep), "");
}

TEST(BareIdl, IgnoresCommentsAndBlanksOnly) {
  EXPECT_EQ(BareIdl("struct A { // one\n  double x; /* two\n */ };"),
            BareIdl("struct A{double x;};"));
  EXPECT_NE(BareIdl("struct A { double x; };"), BareIdl("struct A { double y; };"));
}

}  // namespace
}  // namespace sinew::recording
