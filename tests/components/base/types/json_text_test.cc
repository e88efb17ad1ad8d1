#include "components/base/types/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sinew::types {
namespace {

using Json = nlohmann::json;

std::string ErrorOf(const std::string& text, const std::string& name = "a.json") {
  try {
    (void)ParseJson<Json>(text, name);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string Nested(int levels, const char* inner = "") {
  return std::string(static_cast<std::size_t>(levels), '[') + inner +
         std::string(static_cast<std::size_t>(levels), ']');
}

TEST(ParseJson, NamesFileAndLine) {
  EXPECT_EQ(ParseJson<Json>("{\"a\": [1, 2]}", "a.json")["a"][1], 2);
  EXPECT_EQ(ErrorOf("{\n\"a\": 1,\n}"), "a.json:3: no valid JSON");
  EXPECT_EQ(ErrorOf(""), "a.json:1: no valid JSON");
  EXPECT_EQ(ErrorOf("1e999"), "a.json: no valid JSON");
  EXPECT_EQ(ErrorOf("[", ""), "no valid JSON");
}

TEST(ParseJson, RefusesMoreLevelsThanAnyFileHas) {
  EXPECT_EQ(ErrorOf(Nested(kDeepestJson)), "");
  EXPECT_EQ(ErrorOf("\n" + Nested(kDeepestJson + 1)), "a.json:2: JSON of more than 100 levels");
  EXPECT_EQ(ErrorOf(Nested(1'000'000)), "a.json:1: JSON of more than 100 levels");
  // Neither many that are closed again, nor brackets in texts, behind a quote in one as well.
  std::string many = "[";
  for (int i = 0; i < 500; ++i) many += "[{}],";
  EXPECT_EQ(ErrorOf(many + "\"\\\"" + std::string(500, '[') + "\"]"), "");
  EXPECT_THROW((void)ParseJson<Json>("[1]", "", 0), std::invalid_argument);
  EXPECT_EQ(ParseJson<Json>("1.5", "", 0), 1.5);
}

}  // namespace
}  // namespace sinew::types
