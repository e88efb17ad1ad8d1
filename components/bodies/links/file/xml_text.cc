#include "components/bodies/links/file/xml_text.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

#include "components/base/config/config.h"

namespace sinew::arm {

namespace {

// Position after the first `end` from `at` on; npos where there is none.
std::size_t After(std::string_view xml, std::string_view end, std::size_t at) {
  const std::size_t found = xml.find(end, at);
  return found == std::string_view::npos ? found : found + end.size();
}

// Position after the '>' of the tag of an element; a value in quotes may hold one.
std::size_t AfterTag(std::string_view xml, std::size_t at) {
  while (true) {
    at = xml.find_first_of("\"'>", at);
    if (at == std::string_view::npos) return at;
    if (xml[at] == '>') return at + 1;
    at = After(xml, xml.substr(at, 1), at + 1);
    if (at == std::string_view::npos) return at;
  }
}

// As TinyXML has it: letters of ASCII and whatever is beyond.
bool BeginsName(std::string_view text) {
  if (text.empty()) return false;
  const auto first = static_cast<unsigned char>(text.front());
  return first >= 127 || std::isalpha(first) != 0 || first == '_';
}

// TinyXML has rules of its own for quotes in a declaration: only what every rule reads alike.
bool IsPlainDeclaration(std::string_view tag) {
  static const std::regex kPlain(R"re(<\?[\w-]+(\s+\w+\s*=\s*("[^"'<>=]*"|'[^"'<>=]*'))*\s*\?>)re");
  constexpr std::size_t kLongest = 1000;  // std::regex visits letters by recursion
  return tag.size() <= kLongest && std::regex_match(tag.begin(), tag.end(), kPlain);
}

bool BeginsDeclaration(std::string_view text) {
  constexpr std::string_view kBegin = "<?xml";
  return text.size() >= kBegin.size() &&
         std::equal(kBegin.begin(), kBegin.end(), text.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

// Not what stands in an element `gazebo`.
bool IsOfVisual(const TiXmlNode& material, const TiXmlElement& robot) {
  const TiXmlNode* visual = material.Parent();
  return visual->ValueStr() == "visual" && visual->Parent()->ValueStr() == "link" &&
         visual->Parent()->Parent() == &robot;
}

}  // namespace

XmlProblem FindXmlProblem(std::string_view xml) {
  std::size_t levels = 0;
  const auto problem = [&xml](std::size_t at, const std::string& what) {
    const auto end = xml.begin() + static_cast<std::ptrdiff_t>(at);
    return XmlProblem{1 + static_cast<int>(std::count(xml.begin(), end, '\n')), what};
  };
  for (std::size_t at = xml.find('<'); at < xml.size(); at = xml.find('<', at)) {
    const std::size_t begin = at;
    const std::string_view tag = xml.substr(begin);
    if (tag.starts_with("<!--")) {
      at = After(xml, "-->", begin + 4);
    } else if (tag.starts_with("<![CDATA[")) {
      at = After(xml, "]]>", begin + 9);
    } else if (BeginsName(tag.substr(1))) {
      if (++levels > kMostXmlLevels) {
        return problem(begin, "more than " + std::to_string(kMostXmlLevels) +
                                  " elements inside each other, expected a URDF");
      }
      at = AfterTag(xml, begin);
      if (at != std::string_view::npos && xml[at - 2] == '/') --levels;
    } else {
      at = After(xml, ">", begin);
      if (tag.starts_with("</") && levels > 0) --levels;
      if (BeginsDeclaration(tag) && !IsPlainDeclaration(xml.substr(begin, at - begin))) {
        return problem(begin, "no plain declaration, expected <?xml version=\"1.0\"?>");
      }
    }
  }
  return {};
}

void ParseXml(const std::string& xml, const std::string& name, TiXmlDocument* document) {
  XmlProblem problem = FindXmlProblem(xml);
  if (problem.line == 0) {
    document->Parse(xml.c_str());
    if (!document->Error()) return;
    problem = {std::max(1, document->ErrorRow()),
               std::string("no valid XML: ") + document->ErrorDesc()};
  }
  throw UsageError(name + ":" + std::to_string(problem.line) + ": " + problem.what);
}

std::vector<TiXmlElement*> ElementsIn(TiXmlElement& root) {
  std::vector<TiXmlElement*> elements;
  for (TiXmlElement* e = root.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    elements.push_back(e);
    const auto inside = ElementsIn(*e);
    elements.insert(elements.end(), inside.begin(), inside.end());
  }
  return elements;
}

std::string PlaceIn(const std::string& name, const TiXmlElement& element) {
  const TiXmlNode* link = &element;
  while (link->Parent() != nullptr && link->ValueStr() != "link") link = link->Parent();
  const char* of = link->ToElement() == nullptr ? nullptr : link->ToElement()->Attribute("name");
  return name + ":" + std::to_string(element.Row()) + ": " +
         (of == nullptr ? "" : "link '" + std::string(of) + "': ");
}

void DefineMaterials(const std::string& name, TiXmlElement* robot) {
  std::map<std::string, const TiXmlElement*> defined, used;
  for (const TiXmlElement* material : ElementsIn(*robot)) {
    const bool of_robot = material->Parent() == robot;
    if (material->ValueStr() != "material" || !(of_robot || IsOfVisual(*material, *robot)))
      continue;
    const char* given = material->Attribute("name");
    const std::string of = given == nullptr ? "" : given;
    if (material->FirstChildElement("color") == nullptr &&
        material->FirstChildElement("texture") == nullptr) {
      if (given == nullptr || !of.empty()) used.emplace(of, material);
    } else if (of_robot || !defined.contains(of)) {
      defined[of] = material;
    }
  }
  for (const auto& [of, material] : used) {
    const auto found = defined.find(of);
    if (found == defined.end() || material->Parent() == robot) {
      throw UsageError(PlaceIn(name, *material) + "material '" + of +
                       "' has no color, expected one here or in a material of this name");
    }
    if (found->second->Parent() == robot) continue;
    robot->InsertBeforeChild(robot->FirstChild(), *found->second);
  }
}

}  // namespace sinew::arm
