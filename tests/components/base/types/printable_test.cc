#include "components/base/types/printable.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "components/base/types/json_text.h"

namespace sinew::types {
namespace {

TEST(Printable, ShowsControlCharacters) {
  EXPECT_EQ(Printable("a\x1b[2Jb\x07\x7f"), "a\\u001b[2Jb\\u0007\\u007f");
  EXPECT_EQ(Printable(std::string_view("\0", 1)), "\\u0000");
  EXPECT_EQ(Printable("1\n2\r3\t4"), "1\\n2\\r3\\t4");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "2J"),
            "\\u009b2J")
      << "CSI as UTF-8";
}

TEST(Printable, KeepsLinesWhereThereMayBeMany) {
  EXPECT_EQ(Printable("1\n2\t\x1b\r", Lines::kMany), "1\n2\t\\u001b\\r");
  EXPECT_TRUE(IsPrintable("1\n2\t", Lines::kMany));
  EXPECT_FALSE(IsPrintable("1\n2\t"));
}

TEST(Printable, KeepsAllElse) {
  for (const char* text : {"", "joint 'a' 3.5 N m", "µ° § übergroß", "\\u001b", "\xc2"}) {
    EXPECT_EQ(Printable(text), text);
    EXPECT_TRUE(IsPrintable(text)) << text;
  }
}

TEST(Utf8, WhatIsNoneHasReplacementCharacters) {
  EXPECT_EQ(Utf8("Fl\xC3\xBCgel \xE2\x82\xAC"), "Fl\xC3\xBCgel \xE2\x82\xAC");
  EXPECT_EQ(Utf8("Fl\xFCgel.csv"), "Fl\uFFFDgel.csv");
  EXPECT_EQ(Utf8("\xE2\x82"), "\uFFFD");  // ends inside of a character
  EXPECT_EQ(JsonText(nlohmann::json{{"file", "\xFC"}}), "{\"file\":\"\uFFFD\"}");
}

TEST(Entities, AreThoseOfHtmlAndXml) {
  EXPECT_EQ(Entities("a < b > \"c\" & 'd'"), "a &lt; b &gt; &quot;c&quot; &amp; 'd'");
}

}  // namespace
}  // namespace sinew::types
