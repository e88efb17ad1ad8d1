#include "components/base/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace sinew::config {
namespace {

using ::testing::HasSubstr;

Section Make(const std::string& body) {
  return Section::Parse("schema: test/1\n" + body, "f.yaml", "test/1");
}

template <class Call>
std::string ErrorOf(Call call) {
  try {
    call();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Config, ReadsNumbersTextsAndLists) {
  const Section section =
      Make("gain_Nm_rad: 2.5\nname: rig\nlist_s: [1, 2e-3]\nnodes: [3, 7]\nchild: {on: true}\n");
  EXPECT_EQ(section.Number("gain_Nm_rad"), 2.5);
  EXPECT_EQ(section.Text("name"), "rig");
  EXPECT_EQ(section.Numbers("list_s"), (std::vector<double>{1.0, 0.002}));
  EXPECT_EQ(section.Integers("nodes"), (std::vector<std::int64_t>{3, 7}));
  EXPECT_TRUE(section.Child("child").BoolOr("on", false));
  EXPECT_NO_THROW(section.RejectUnknownKeys());
}

TEST(Config, NamesFileLineAndKeyOfAnUnknownKey) {
  const Section section = Make("gain: 1\ngian: 2\n");
  section.Number("gain");
  EXPECT_EQ(ErrorOf([&] { section.RejectUnknownKeys(); }),
            "f.yaml:3: key 'gian': unknown, expected one of gain, schema");
}

TEST(Config, NamesTheUnitThatWasExpected) {
  const Section missing = Make("viscous_Nm: 1\n");
  EXPECT_EQ(ErrorOf([&] { missing.Number("viscous_Nm_s_rad"); }),
            "f.yaml:2: key 'viscous_Nm': wrong unit, expected 'viscous_Nm_s_rad'");
  const Section optional = Make("limit_deg: 1\n");
  if (optional.Has("limit_rad")) optional.Number("limit_rad");
  EXPECT_EQ(ErrorOf([&] { optional.RejectUnknownKeys(); }),
            "f.yaml:2: key 'limit_deg': wrong unit, expected 'limit_rad'");
}

TEST(Config, RefusesWhatIsNoFiniteNumberInRange) {
  for (const char* bad : {".nan", "nan", ".inf", "1,5", "abc", "1 Nm", "[1]", "-1", "0x10"}) {
    const Section section = Make(std::string("rate_Hz: ") + bad + "\n");
    EXPECT_THAT(ErrorOf([&] { section.Number("rate_Hz", kPositive); }),
                HasSubstr("f.yaml:2: key 'rate_Hz': "))
        << bad;
  }
  EXPECT_THAT(ErrorOf([&] { Make("n: 1.5\n").Integer("n"); }), HasSubstr("whole number"));
  EXPECT_THAT(ErrorOf([&] { Make("n: [1, 1.5]\n").Integers("n"); }), HasSubstr("whole number"));
}

TEST(Config, RefusesTimesThatAreNoWholeNanosecondsOfACentury) {
  EXPECT_EQ(ErrorOf([] { Make("wait_s: 1e300\n").Number("wait_s"); }),
            "f.yaml:2: key 'wait_s': '1e300', expected 0, or 0 to 3.15576e+09 (a century)");
  for (const char* bad :
       {"a_ms: 1e13", "a_us: -1e300", "a_ns: 1e19", "a_Hz: 1e-300", "a_Hz: 1e10"}) {
    const std::string key = std::string(bad).substr(0, 4);
    EXPECT_THAT(ErrorOf([&] { Make(bad).Number(key); }), HasSubstr("(a century)")) << bad;
  }
  EXPECT_EQ(Make("a_Hz: 0\n").Number("a_Hz"), 0.0);
  EXPECT_EQ(Make("a_N: 1e300\n").Number("a_N"), 1e300);
}

TEST(Config, NamesTheWholePathOfANestedKey) {
  const Section section = Make("terms:\n  - effect: viscous\n  - effekt: coulomb\n");
  const auto terms = section.List("terms");
  ASSERT_EQ(terms.size(), 2u);
  EXPECT_EQ(ErrorOf([&] { terms[1].Text("effect"); }),
            "f.yaml:4: key 'terms[1].effect': missing, expected text");
}

TEST(Config, RejectsUnknownKeysInChildrenToo) {
  const Section section = Make("child: {known: 1, other: 2}\n");
  section.Child("child").Number("known");
  EXPECT_THAT(ErrorOf([&] { section.RejectUnknownKeys(); }),
              HasSubstr("key 'child.other': unknown"));
}

TEST(Config, RefusesAnotherSchemaAndBrokenYaml) {
  EXPECT_THAT(ErrorOf([] { Section::Parse("schema: other/1\n", "f.yaml", "test/1"); }),
              HasSubstr("f.yaml:1: key 'schema': 'other/1', expected 'test/1'"));
  EXPECT_THAT(ErrorOf([] { Section::Parse("a: [1\nb: 2", "f.yaml", "test/1"); }),
              HasSubstr("no valid YAML"));
  EXPECT_THAT(ErrorOf([] { Section::Parse("", "f.yaml", "test/1"); }),
              HasSubstr("expected a mapping"));
  EXPECT_THAT(ErrorOf([] { Make("a: 1\na: 2\n"); }), HasSubstr("given twice"));
}

TEST(Config, ListsTheAllowedWords) {
  EXPECT_EQ(ErrorOf([] {
              Make("mode: fast\n").Choice("mode", {"slow", "medium"});
            }),
            "f.yaml:2: key 'mode': 'fast', expected one of slow, medium");
}

TEST(Config, WritesAFileWholeOrNotAtAll) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("config_test." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  WriteFileAtomically(folder / "a.txt", "one");
  WriteFileAtomically(folder / "a.txt", "two");
  EXPECT_EQ(ReadFile(folder / "a.txt"), "two");
  EXPECT_THAT(ErrorOf([&] { WriteFileAtomically(folder / "absent" / "a.txt", "x"); }),
              HasSubstr("absent/a.txt: cannot be written: No such file"));
  EXPECT_THAT(ErrorOf([&] { ReadFile(folder / "none.txt"); }),
              HasSubstr("none.txt: cannot be read"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace sinew::config
