#include "sim/render/file/scene_file.h"

#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/bodies/links/file/xml_text.h"

namespace sinew::render {

namespace {

using Eigen::Vector3d;

// Throws with the line of an element.
class SceneReader {
 public:
  explicit SceneReader(std::string file) : file_(std::move(file)) {}

  void ReadMaterials(const TiXmlElement& robot) {
    for (const TiXmlElement* e = robot.FirstChildElement("material"); e != nullptr;
         e = e->NextSiblingElement("material")) {
      const std::optional<Colour> colour = ReadColour(*e);
      if (colour && e->Attribute("name") != nullptr) materials_[e->Attribute("name")] = *colour;
    }
  }

  // Nothing for a mesh.
  std::optional<Visual> ReadVisual(const TiXmlElement& element) const {
    Visual out;
    if (const TiXmlElement* origin = element.FirstChildElement("origin")) {
      const Vector3d rpy = NumbersOr(*origin, "rpy", Vector3d::Zero());
      out.link_from_visual.translate(NumbersOr(*origin, "xyz", Vector3d::Zero()));
      out.link_from_visual.rotate(Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()));
    }
    if (const TiXmlElement* material = element.FirstChildElement("material")) {
      out.colour = FindColour(*material);
    }
    const TiXmlElement* geometry = element.FirstChildElement("geometry");
    const TiXmlElement* form = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (form == nullptr) Fail(element, "has no geometry");
    const std::string& kind = form->ValueStr();
    if (kind == "mesh") return std::nullopt;
    if (kind == "box") {
      out.shape = Shape::kBox;
      out.size_m = Numbers<3>(*form, "size");
      for (const double edge_m : out.size_m) RequirePositive(*form, "size", edge_m);
    } else if (kind == "cylinder") {
      out.shape = Shape::kCylinder;
      const double radius_m = Length(*form, "radius");
      out.size_m = {radius_m, radius_m, Length(*form, "length")};
    } else if (kind == "sphere") {
      out.shape = Shape::kSphere;
      out.size_m.setConstant(Length(*form, "radius"));
    } else {
      Fail(*form, "'" + kind + "' is no geometry, expected box, cylinder, sphere or mesh");
    }
    return out;
  }

 private:
  [[noreturn]] void Fail(const TiXmlElement& element, const std::string& message) const {
    throw UsageError(arm::PlaceIn(file_, element) + element.ValueStr() + ": " + message);
  }

  template <int count>
  Eigen::Matrix<double, count, 1> Numbers(const TiXmlElement& element, const char* key) const {
    const char* text = element.Attribute(key);
    if (text == nullptr) Fail(element, std::string(key) + " is missing");
    std::istringstream words(text);
    Eigen::Matrix<double, count, 1> out;
    std::string rest;
    for (double& value : out) {
      if (!(words >> value) || !std::isfinite(value)) Refuse(element, key, count, text);
    }
    if (words >> rest) Refuse(element, key, count, text);
    return out;
  }

  [[noreturn]] void Refuse(const TiXmlElement& element, const char* key, int count,
                           const std::string& text) const {
    Fail(element, std::string(key) + " is '" + text + "', expected " + std::to_string(count) +
                      (count == 1 ? " number" : " numbers"));
  }

  Vector3d NumbersOr(const TiXmlElement& element, const char* key, const Vector3d& absent) const {
    return element.Attribute(key) == nullptr ? absent : Vector3d(Numbers<3>(element, key));
  }

  void RequirePositive(const TiXmlElement& element, const char* key, double value) const {
    if (value > 0.0) return;
    Fail(element, std::string(key) + " is '" + element.Attribute(key) + "', expected m above 0");
  }

  double Length(const TiXmlElement& element, const char* key) const {
    const double value = Numbers<1>(element, key)[0];
    RequirePositive(element, key, value);
    return value;
  }

  // Nothing where the material has no colour of its own.
  std::optional<Colour> ReadColour(const TiXmlElement& material) const {
    const TiXmlElement* colour = material.FirstChildElement("color");
    if (colour == nullptr) return std::nullopt;
    const Eigen::Vector4d rgba = Numbers<4>(*colour, "rgba");
    if (rgba.minCoeff() < 0.0 || rgba.maxCoeff() > 1.0) {
      Fail(*colour,
           "rgba is '" + std::string(colour->Attribute("rgba")) + "', expected 0 to 1 each");
    }
    return Colour{rgba[0], rgba[1], rgba[2]};
  }

  Colour FindColour(const TiXmlElement& material) const {
    if (const std::optional<Colour> own = ReadColour(material)) return *own;
    if (material.FirstChildElement("texture") != nullptr) return {};
    const auto found = materials_.find(material.Attribute("name"));
    return found == materials_.end() ? Colour{} : found->second;  // "", or a texture
  }

  std::string file_;
  std::map<std::string, Colour> materials_;
};

// Index of a link; -1: the base.
int BodyOf(const arm::Chain& chain, const std::string& link) {
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (chain.bodies[i].link_name == link) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

Scene ParseScene(const std::string& xml, const std::string& file_name) {
  // The visuals first: the parser of the bodies refuses bad ones without a line. Its own complaints
  // about the rest are better than any here.
  struct Drawn {
    std::string link;
    Visual visual;
  };
  std::vector<Drawn> drawn;
  Scene scene;
  TiXmlDocument document;
  arm::ParseXml(xml, file_name, &document);
  if (TiXmlElement* robot = document.RootElement()) {
    arm::DefineMaterials(file_name, robot);
    SceneReader reader(file_name);
    reader.ReadMaterials(*robot);
    for (const TiXmlElement* link = robot->FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
      for (const TiXmlElement* e = link->FirstChildElement("visual"); e != nullptr;
           e = e->NextSiblingElement("visual")) {
        const std::optional<Visual> visual = reader.ReadVisual(*e);
        if (!visual) {
          ++scene.mesh_count;
        } else if (link->Attribute("name") != nullptr) {
          drawn.push_back({link->Attribute("name"), *visual});
        }
      }
    }
  }
  scene.chain = arm::ParseUrdf(xml, file_name);
  for (Drawn& one : drawn) {
    one.visual.body = BodyOf(scene.chain, one.link);
    scene.visuals.push_back(one.visual);
  }
  if (scene.visuals.empty()) {
    throw UsageError(
        file_name + ": nothing to draw: no visual is a box, a cylinder or a sphere" +
        (scene.mesh_count > 0 ? " (" + std::to_string(scene.mesh_count) + " are meshes)" : ""));
  }
  return scene;
}

Scene LoadScene(const std::filesystem::path& urdf) {
  return ParseScene(config::ReadFile(urdf), urdf.string());
}

}  // namespace sinew::render
