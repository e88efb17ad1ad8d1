// Rigid groups of stance_model.h: links that no moving joint parts, their mass, middle and size;
// torques of a joint as a stacked column.
#include <algorithm>

#include "components/model/stance_fit/stance_model.h"

namespace sinew::stance_fit {

Eigen::VectorXd StanceRows::AtJoint(const StanceLayout& layout, std::size_t joint,
                                    const Eigen::Ref<const Eigen::VectorXd>& torque_Nm) const {
  const auto row = static_cast<Eigen::Index>(joint) + arm::kBaseFreedom;
  const auto found = std::find(layout.rows.begin(), layout.rows.end(), row);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(stacked());
  if (found == layout.rows.end()) return out;
  const Eigen::Index at = found - layout.rows.begin(), m = layout.channels();
  for (Eigen::Index i = 0; i < size(); ++i) {
    out.segment(i * m, m) = torque_Nm[i] * project[static_cast<std::size_t>(i)].col(at);
  }
  return out;
}

double StanceModel::MassOf(const RigidGroup& group) const {
  double sum = group.link == arm::kBaseLink ? links_.base[0] : 0.0;
  for (const arm::MovingLink& link : links_.links) {
    const auto& names = group.link_names;
    if (std::find(names.begin(), names.end(), link.link_name) != names.end()) {
      sum += link.inertial[0];
    }
  }
  return sum;
}

std::vector<RigidGroup> StanceModel::Groups(const std::vector<char>& moves) const {
  std::vector<RigidGroup> out = {{arm::kBaseLink, "", {}}};
  const std::string first = dynamics_.parameter_names().front();
  out.front().name = first.substr(0, first.rfind('.'));
  out.front().link_names.push_back(out.front().name);
  std::vector<std::size_t> group_of;
  for (std::size_t l = 0; l < links_.links.size(); ++l) {
    const arm::MovingLink& link = links_.links[l];
    const auto found = std::find(joint_.begin(), joint_.end(), static_cast<Eigen::Index>(l));
    const bool parted =
        found != joint_.end() && moves[static_cast<std::size_t>(found - joint_.begin())] != 0;
    std::size_t group = link.parent < 0 ? 0 : group_of[static_cast<std::size_t>(link.parent)];
    if (parted) {
      group = out.size();
      out.push_back({static_cast<int>(l), link.link_name, {}});
    }
    out[group].link_names.push_back(link.link_name);
    group_of.push_back(group);
  }
  Measure(group_of, &out);
  return out;
}

void StanceModel::Measure(const std::vector<std::size_t>& group_of,
                          std::vector<RigidGroup>* groups) const {
  const std::size_t count = links_.links.size();
  std::vector<Eigen::Isometry3d> pose(count, Eigen::Isometry3d::Identity());  // joints at 0
  const auto pose_of = [&](int link) {
    return link < 0 ? Eigen::Isometry3d::Identity() : pose[static_cast<std::size_t>(link)];
  };
  for (std::size_t l = 0; l < count; ++l) {
    pose[l] = pose_of(links_.links[l].parent) * links_.links[l].parent_from_joint;
  }
  const auto group = [&](int link) {
    return link < 0 ? 0 : group_of[static_cast<std::size_t>(link)];
  };
  for (RigidGroup& one : *groups) {
    const Eigen::Vector4d moments =
        dynamics_.nominal().segment<4>(arm::kParametersPerBody * (one.link + 1));
    if (moments[0] > 0.0) one.center_m = moments.tail<3>() / moments[0];
  }
  const auto reach = [&](std::size_t of, const Eigen::Vector3d& point) {
    RigidGroup& one = (*groups)[of];
    const Eigen::Vector3d here = pose_of(one.link).inverse() * point;
    one.size_m = std::max(one.size_m, (here - one.center_m).norm());
  };
  for (const arm::Carried& body : links_.bodies) {
    reach(group(body.link), pose_of(body.link) * body.link_from_body.translation());
  }
  for (std::size_t l = 0; l < count; ++l) {
    reach(group(links_.links[l].parent), pose[l].translation());
  }
}

}  // namespace sinew::stance_fit
