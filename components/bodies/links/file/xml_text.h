// Text as XML, for everything that reads a URDF. TinyXML and urdfdom visit elements and links by
// recursion, so how many there may be inside each other is checked before they see the text.
#pragma once

#include <tinyxml.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::arm {

// Elements inside each other, as TinyXML 2 allows (TINYXML2_MAX_ELEMENT_DEPTH). A URDF needs 5, of
// a plugin's settings perhaps 10. TinyXML needs below 1 KiB of stack for each.
inline constexpr std::size_t kMostXmlLevels = 100;

// Reason to keep a text from TinyXML, and its line. Levels are counted exactly for what it reads.
struct XmlProblem {
  int line = 0;  // 0: none
  std::string what;
};
XmlProblem FindXmlProblem(std::string_view xml);

// Throws UsageError, "NAME:LINE: ...", for what is no XML and for what FindXmlProblem finds.
void ParseXml(const std::string& xml, const std::string& name, TiXmlDocument* document);

// All elements inside of one, in the order of the file.
std::vector<TiXmlElement*> ElementsIn(TiXmlElement& root);

// "NAME:LINE: ", and "link '...': " for what is inside of one.
std::string PlaceIn(const std::string& name, const TiXmlElement& element);

// Gives the robot a material of each name that a visual has without colour or texture and that a
// visual of any link defines, the first of them: readers of URDFs look for it there. Throws
// UsageError, "NAME:LINE: ...", for a material that nothing defines.
void DefineMaterials(const std::string& name, TiXmlElement* robot);

}  // namespace sinew::arm
