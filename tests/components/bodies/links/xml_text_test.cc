// Levels of a text, counted before TinyXML visits them by recursion.
#include "components/bodies/links/file/xml_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "components/base/config/config.h"

namespace sinew::arm {
namespace {

std::string Repeated(const std::string& text, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += text;
  return out;
}

// kMostXmlLevels elements with a text in the innermost.
std::string Around(const std::string& text) {
  return Repeated("<a>", kMostXmlLevels) + text + Repeated("</a>", kMostXmlLevels);
}

std::string ErrorOf(const std::string& xml) {
  TiXmlDocument document;
  try {
    ParseXml(xml, "f.urdf", &document);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

std::size_t LevelsOf(const TiXmlNode& node) {
  std::size_t most = 0;
  for (const TiXmlNode* child = node.FirstChild(); child != nullptr; child = child->NextSibling()) {
    most = std::max(most, LevelsOf(*child) + (child->ToElement() != nullptr ? 1 : 0));
  }
  return most;
}

TEST(XmlText, TooManyElementsInsideEachOtherAreAnErrorWithALine) {
  EXPECT_EQ(ErrorOf(Around("")), "no error");
  EXPECT_EQ(ErrorOf(Around("\n<b></b>")),
            "f.urdf:2: more than 100 elements inside each other, expected a URDF");
  EXPECT_EQ(ErrorOf(Around("<b/>")), ErrorOf("<a>" + Around("") + "</a>"));
  EXPECT_EQ(ErrorOf("<r>" + Repeated("<a b='>'/><a></a>", 200) + "</r>"), "no error");
  EXPECT_EQ(ErrorOf(Repeated("<a>", 200000)),
            "f.urdf:1: more than 100 elements inside each other, expected a URDF");
}

TEST(XmlText, WhatNestsNothingIsNotCounted) {
  for (const char* text : {"<!-- <b> -->", "<![CDATA[<b>]]>", "<?note <b>", "<!b >", "a < b"}) {
    EXPECT_EQ(FindXmlProblem(Around(text)).line, 0) << text;
  }
}

TEST(XmlText, ADeclarationIsPlain) {
  EXPECT_EQ(ErrorOf("<?xml version=\"1.0\" encoding='utf-8'?>\n<a/>"), "no error");
  EXPECT_EQ(ErrorOf("<?XML x' version=\"?>\n<a/>"),
            "f.urdf:1: no plain declaration, expected <?xml version=\"1.0\"?>");
}

TEST(XmlText, NoLevelOfTinyXmlIsOverlooked) {
  constexpr std::array<const char*, 24> kPieces = {
      "<a>", "</a>",   "<b c='1'>", "</b>",     "<a/>", "<!--", "-->", "<![CDATA[",
      "]]>", "<?xml ", "?>",        "<?x ",     "'",    "\"",   "<",   ">",
      "/",   "=",      " ",         "version=", "<!x",  "a",    "\n",  "<_"};
  std::mt19937 random(1);
  std::size_t deepest = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text;
    for (int i = 0; i < 12; ++i) text += kPieces[random() % kPieces.size()];
    // Two levels are left.
    const std::string xml = Repeated("<a>", kMostXmlLevels - 2) + text;
    if (FindXmlProblem(xml).line > 0) continue;
    TiXmlDocument document;
    document.Parse(xml.c_str());
    const std::size_t levels = LevelsOf(document);
    ASSERT_LE(levels, kMostXmlLevels) << text;
    deepest = std::max(deepest, levels);
  }
  EXPECT_EQ(deepest, kMostXmlLevels);
}

}  // namespace
}  // namespace sinew::arm
