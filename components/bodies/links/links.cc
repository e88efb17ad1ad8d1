#include "components/bodies/links/links.h"

namespace sinew::arm {

MovingLinks MovingLinksOf(const Chain& chain) {
  MovingLinks out;
  const auto identity = Eigen::Isometry3d::Identity();
  out.base = InertialIn(identity, chain.base.mass_kg, chain.base.com_m, chain.base.inertia_kg_m2);
  for (const Body& body : chain.bodies) {
    const Carried on =
        body.parent < 0 ? Carried{} : out.bodies[static_cast<std::size_t>(body.parent)];
    const Eigen::Isometry3d in_link = on.link_from_body * body.parent_from_joint;
    if (body.moves) {
      RequireFree(body);
      out.bodies.push_back({static_cast<int>(out.links.size()), identity});
      out.links.push_back({on.link, body.prismatic, in_link, body.axis.normalized(), body.link_name,
                           body.joint_name,
                           InertialIn(identity, body.mass_kg, body.com_m, body.inertia_kg_m2)});
      out.joint_names.push_back(body.joint_name);
      continue;
    }
    out.bodies.push_back({on.link, in_link});
    Inertial& carrier =
        on.link == kBaseLink ? out.base : out.links[static_cast<std::size_t>(on.link)].inertial;
    carrier += InertialIn(in_link, body.mass_kg, body.com_m, body.inertia_kg_m2);
  }
  return out;
}

void AppendParameterNames(const std::string& link_name, std::vector<std::string>* names) {
  for (const char* name : {"m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"}) {
    names->push_back(link_name + "." + name);
  }
}

}  // namespace sinew::arm
