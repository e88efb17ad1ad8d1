// Aliases of YAML: what they stand for is counted before a node is made.
#include "components/base/config/yaml_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"

namespace sinew::config {
namespace {

using ::testing::HasSubstr;

std::string YamlErrorOf(const std::string& text) {
  try {
    ParseYaml(text, "f.yaml");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

// `count` lines, in each of which `width` aliases of the line before stand inside `levels` lists.
std::string Chain(int count, int width, std::size_t levels) {
  std::string text = "x0: &x0 [1]\n";
  for (int i = 1; i <= count; ++i) {
    const std::string name = "x" + std::to_string(i), before = "*x" + std::to_string(i - 1);
    text += name + ": &" + name + " " + std::string(levels, '[') + before;
    for (int k = 1; k < width; ++k) text += ", " + before;
    text += std::string(levels, ']') + "\n";
  }
  return text;
}

TEST(YamlText, AliasesOfFinishedValuesAreRead) {
  const YAML::Node node = ParseYaml("a: &a {b: 1}\nc: [*a, *a]\nd: &a 2\ne: *a\n", "f.yaml");
  EXPECT_EQ(node["c"][1]["b"].Scalar(), "1");
  EXPECT_EQ(node["e"].Scalar(), "2");
}

TEST(YamlText, AValueInItselfIsRefused) {
  for (const char* text : {"k: 1\na: &a [*a]\n", "k: 1\na: &a {b: {c: *a}}\n"}) {
    EXPECT_EQ(YamlErrorOf(text),
              "f.yaml:2: a value contains itself by an alias, expected aliases of values that "
              "ended");
  }
}

TEST(YamlText, AliasesOfAliasesAreCounted) {
  EXPECT_EQ(YamlErrorOf(Chain(5, 10, 1)), "no error");
  EXPECT_EQ(YamlErrorOf(Chain(12, 10, 1)),
            "f.yaml:7: more than 1048576 values with those of aliases, expected fewer");
}

TEST(YamlText, LevelsOfAliasesAreCounted) {
  EXPECT_EQ(YamlErrorOf(Chain(4, 1, 100)), "no error");
  EXPECT_EQ(YamlErrorOf(Chain(20, 1, 100)),
            "f.yaml:6: more than 500 levels with those of aliases, expected fewer");
}

TEST(YamlText, TextWithTooManyLevelsIsNoYaml) {
  EXPECT_THAT(YamlErrorOf("a: " + std::string(100000, '[')),
              HasSubstr("f.yaml:1: no valid YAML: "));
}

TEST(YamlText, AKeyThatIsGivenTwiceIsRefusedAtAnyDepth) {
  const struct {
    const char *text, *says;
  } kCases[] = {
      {"a: 1\nb: 2\na: 3\n", "f.yaml:3: key 'a': given twice"},
      {"a: {b: 1, c: 2, b: 3}\n", "f.yaml:1: key 'a.b': given twice"},
      {"joints:\n  - {x: 1}\n  - x: [1, {y: 2}]\n    z: 1\n    x: 2\n",
       "f.yaml:5: key 'joints[1].x': given twice"},
      {"a: &a {b: 1}\nc: *a\na: 2\n", "f.yaml:3: key 'a': given twice"},
      {"[{a: 1}, {b: {c: 1, \"c\": 1}}]\n", "f.yaml:1: key '[1].b.c': given twice"},
  };
  for (const auto& [text, says] : kCases) EXPECT_EQ(YamlErrorOf(text), says);
  EXPECT_EQ(YamlErrorOf("a: {b: 1}\nc: [{b: 1}, {b: 2}]\nb: a\n"), "no error");
}

TEST(YamlText, AKeyWithoutAValueIsRefused) {
  for (const char* value : {"", "null", "~"}) {
    EXPECT_EQ(YamlErrorOf("a: [{k: 1}, {x: 1, k: " + std::string(value) + "}]\n"),
              "f.yaml:1: key 'a[1].k': empty, expected a value");
  }
  EXPECT_EQ(YamlErrorOf("a: ''\nb: []\n"), "no error");
}

TEST(YamlText, ASecondDocumentIsRefused) {
  EXPECT_EQ(YamlErrorOf("---\na: 1\n...\n# the end\n"), "no error");
  EXPECT_EQ(YamlErrorOf("a: 1\n---\nb: 2\n"),
            "f.yaml:2: a second document begins here, expected one in a file");
}

TEST(YamlText, ConfigurationsRefuseThemToo) {
  try {
    Section::Parse("schema: test/1\na: &a [*a]\n", "f.yaml", "test/1");
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("f.yaml:2: a value contains itself"));
  }
}

}  // namespace
}  // namespace sinew::config
