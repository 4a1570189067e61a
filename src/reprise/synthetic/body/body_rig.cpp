// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/body_rig.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "reprise/core/error.h"

namespace reprise::body {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct JointSource {
  std::string_view name, parent, node;  // the node stands at the joint at rest; "*" is the side
};

constexpr std::array joint_sources = {
    JointSource{"pelvis", "", ""},  // between the hips
    JointSource{"spine", "pelvis", "spine04____head"},
    JointSource{"chest", "spine", "spine02____head"},
    JointSource{"neck", "chest", "neck01____head"},
    JointSource{"head", "neck", "head____head"},
    JointSource{"*collar", "chest", "clavicle.*____head"},
    JointSource{"*upper_arm", "*collar", "upperarm01.*____head"},
    JointSource{"*forearm", "*upper_arm", "lowerarm01.*____head"},
    JointSource{"*hand", "*forearm", "wrist.*____head"},
    JointSource{"*thigh", "pelvis", "upperleg01.*____head"},
    JointSource{"*shin", "*thigh", "lowerleg01.*____head"},
    JointSource{"*foot", "*shin", "foot.*____head"},
    JointSource{"*toe", "*foot", "toe2-1.*____head"},
};

struct BoneSource {
  std::string_view node;           // name of the package's bone; those below it follow it unless named here
  std::string_view joint, parent;  // of the skeleton; parent empty: the joint alone
  double swing = 1.0, twist = 1.0;
  std::string_view child = "";
  double child_twist = 0.0;
};

// How much of each joint's rotation its bones take. Chosen by looking at poses: the sums along a chain reach
// the joint's whole rotation where the next joint begins.
constexpr std::array bone_sources = {
    BoneSource{"root", "pelvis", ""},
    BoneSource{"spine05", "spine", "pelvis", 0.2, 0.2},
    BoneSource{"spine04", "spine", "pelvis", 0.7, 0.7},
    BoneSource{"spine03", "chest", "spine", 0.3, 0.3},
    BoneSource{"spine02", "chest", "spine", 0.8, 0.8},
    BoneSource{"spine01", "chest", ""},
    BoneSource{"neck01", "neck", "chest", 0.6, 0.5},
    BoneSource{"neck02", "head", "neck", 0.0, 0.25},
    BoneSource{"neck03", "head", "neck", 0.5, 0.6},
    BoneSource{"head", "head", ""},
    BoneSource{"pelvis.*", "*thigh", "pelvis", 0.1, 0.0},
    BoneSource{"upperleg01.*", "*thigh", "pelvis", 1.0, 0.5},
    BoneSource{"upperleg02.*", "*thigh", ""},
    BoneSource{"lowerleg01.*", "*shin", "*thigh", 1.0, 0.4},
    BoneSource{"lowerleg02.*", "*shin", "*thigh", 1.0, 1.0, "*foot", 0.4},
    BoneSource{"foot.*", "*foot", ""},
    BoneSource{"toe1-1.*", "*toe", ""},
    BoneSource{"toe2-1.*", "*toe", ""},
    BoneSource{"toe3-1.*", "*toe", ""},
    BoneSource{"toe4-1.*", "*toe", ""},
    BoneSource{"toe5-1.*", "*toe", ""},
    BoneSource{"clavicle.*", "*collar", ""},
    BoneSource{"shoulder01.*", "*upper_arm", "*collar", 0.3, 0.0},
    BoneSource{"upperarm01.*", "*upper_arm", "*collar", 1.0, 0.4},
    BoneSource{"upperarm02.*", "*upper_arm", "*collar", 1.0, 0.85},
    BoneSource{"lowerarm01.*", "*forearm", "*upper_arm", 1.0, 0.5, "*hand", 0.15},
    BoneSource{"lowerarm02.*", "*forearm", "*upper_arm", 1.0, 0.9, "*hand", 0.65},
    BoneSource{"wrist.*", "*hand", ""},
};

std::string sided(std::string_view pattern, std::string_view side) {
  std::string name(pattern);
  if (const auto star = name.find('*'); star != std::string::npos) name.replace(star, 1, side);
  return name;
}

// The part of `rotation` about `axis`; what is left is `rotation * twist^-1`.
Quaterniond twist_about(const Quaterniond& rotation, const Vector3d& axis) {
  const double along = rotation.vec().dot(axis);
  const double length = std::hypot(rotation.w(), along);
  if (length < 1e-9) return Quaterniond::Identity();  // half a turn about another axis: any twist will do
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  Quaterniond twist;
  twist.w() = sign * rotation.w() / length;
  twist.vec() = sign * along / length * axis;
  return twist;
}

Quaterniond part_of(const Quaterniond& rotation, double part) {
  if (part == 1.0) return rotation;
  return Quaterniond::Identity().slerp(part, rotation);
}

}  // namespace

std::vector<RigidTransform> relaxed_fingers(const MakehumanBody& body, const MakehumanPoints& points) {
  constexpr double degree = std::numbers::pi / 180.0;
  // Index to little finger, knuckle to tip. Hanging hands curl more towards the little finger.
  constexpr double curls[4][3] = {{8, 14, 8}, {12, 18, 10}, {15, 20, 11}, {18, 20, 11}};
  std::vector<RigidTransform> transforms(body.nodes.size());
  const auto place = [&](const std::string& name) { return body.node_place(body.node_idx(name), points); };

  std::vector<Quaterniond> turn(body.nodes.size(), Quaterniond::Identity());
  for (const std::string side : {".L", ".R"}) {
    const Vector3d across =
        (place("finger2-1" + side + "____head") - place("finger5-1" + side + "____head")).normalized();
    for (int finger = 2; finger <= 5; ++finger) {
      const auto bone = [&](int k) {
        return "finger" + std::to_string(finger) + "-" + std::to_string(k) + side;
      };
      const Vector3d first = place(bone(1)) - place(bone(1) + "____head");
      const Vector3d last = place(bone(3)) - place(bone(3) + "____head");
      // The package's fingers are bent a little already: that way is towards the palm.
      const Vector3d axis = first.cross(last).dot(across) < 0.0 ? Vector3d(-across) : across;
      for (int k = 1; k <= 3; ++k) {
        const auto node = static_cast<std::size_t>(body.node_idx(bone(k) + "____head"));
        turn[node] = Eigen::AngleAxisd(degree * curls[finger - 2][k - 1], axis);
      }
    }
    // The thumb lies closer to the palm and bends a little at its last joints.
    const auto thumb = [&](int k) { return "finger1-" + std::to_string(k) + side; };
    const Vector3d first = place(thumb(1)) - place(thumb(1) + "____head");
    const Vector3d towards = place("finger2-1" + side + "____head") - place(thumb(1) + "____head");
    const Vector3d close = first.cross(towards).normalized();
    const double thumb_curls[3] = {7, 9, 14};
    for (int k = 1; k <= 3; ++k) {
      const auto node = static_cast<std::size_t>(body.node_idx(thumb(k) + "____head"));
      turn[node] = Eigen::AngleAxisd(degree * thumb_curls[k - 1], close);
    }
  }

  for (std::size_t node = 0; node < body.nodes.size(); ++node) {
    const int parent = body.nodes[node].parent;
    const RigidTransform above = parent < 0 ? RigidTransform{} : transforms[static_cast<std::size_t>(parent)];
    const Vector3d joint = body.node_place(static_cast<int>(node), points);
    transforms[node].rotation = above.rotation * turn[node];
    transforms[node].translation =
        above.rotation * joint + above.translation - transforms[node].rotation * joint;
  }
  return transforms;
}

BodyRig::BodyRig(const MakehumanBody& body, const MakehumanPoints& points) {
  const auto place = [&](const std::string& node) { return body.node_place(body.node_idx(node), points); };
  for (const auto& [side, letter] : {std::pair{"", ""}, std::pair{"left_", "L"}, std::pair{"right_", "R"}}) {
    const bool trunk = *letter == '\0';
    for (const JointSource& source : joint_sources) {
      if ((source.name.find('*') == std::string_view::npos) != trunk) continue;
      Joint joint;
      joint.name = sided(source.name, side);
      joint.parent = source.parent.empty() ? -1 : skeleton_.joint_idx(sided(source.parent, side));
      joint.rest_position =
          source.node.empty()
              ? Vector3d(0.5 * (place("upperleg01.L____head") + place("upperleg01.R____head")))
              : place(sided(source.node, letter));
      skeleton_.joints.push_back(std::move(joint));
    }
  }
  validate(skeleton_);

  bone_of_node_.assign(body.nodes.size(), -1);
  for (const auto& [side, letter] : {std::pair{"left_", "L"}, std::pair{"right_", "R"}}) {
    for (const BoneSource& source : bone_sources) {
      Bone bone;
      bone.joint = skeleton_.joint_idx(sided(source.joint, side));
      if (!source.parent.empty()) {
        bone.parent = skeleton_.joint_idx(sided(source.parent, side));
        bone.swing = source.swing;
        bone.twist = source.twist;
        bone.child_twist = source.child_twist;
        if (!source.child.empty()) bone.child = skeleton_.joint_idx(sided(source.child, side));
        const std::vector<int> children = skeleton_.children(bone.joint);
        if (children.empty()) {
          bone.axis = Vector3d::UnitY();  // the head
        } else {
          const auto rest = [&](int joint) {
            return skeleton_.joints[static_cast<std::size_t>(joint)].rest_position;
          };
          bone.axis = (rest(children.front()) - rest(bone.joint)).normalized();
        }
      }
      const int node = body.node_idx(sided(source.node, letter) + "____head");
      bone_of_node_[static_cast<std::size_t>(node)] = add_bone(bone);
    }
  }
  for (std::size_t node = 0; node < body.nodes.size(); ++node) {
    if (bone_of_node_[node] >= 0) continue;
    const int parent = body.nodes[node].parent;
    bone_of_node_[node] = parent < 0 ? 0 : bone_of_node_[static_cast<std::size_t>(parent)];
  }
}

int BodyRig::add_bone(const Bone& bone) {
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    if (bones_[i] == bone) return static_cast<int>(i);
  }
  bones_.push_back(bone);
  return static_cast<int>(bones_.size()) - 1;
}

std::vector<RigidTransform> BodyRig::transforms(const SkeletonPose& pose) const {
  const auto count = static_cast<std::size_t>(skeleton_.size());
  if (pose.rotation.size() != count || pose.position.size() != count) {
    throw InvalidArgument("expected a pose of the performer's skeleton (" + std::to_string(count) +
                          " joints), found " + std::to_string(pose.rotation.size()) + " rotations and " +
                          std::to_string(pose.position.size()) + " positions");
  }
  std::vector<RigidTransform> transforms;
  for (const Bone& bone : bones_) {
    const auto joint = static_cast<std::size_t>(bone.joint);
    Quaterniond rotation = pose.rotation[joint];
    if (bone.parent >= 0) {
      const Quaterniond& parent = pose.rotation[static_cast<std::size_t>(bone.parent)];
      const Quaterniond relative = parent.conjugate() * rotation;
      const Quaterniond twist = twist_about(relative, bone.axis);
      const Quaterniond swing = relative * twist.conjugate();
      rotation = parent * part_of(swing, bone.swing) * part_of(twist, bone.twist);
      if (bone.child >= 0) {
        const Quaterniond child =
            pose.rotation[joint].conjugate() * pose.rotation[static_cast<std::size_t>(bone.child)];
        rotation = rotation * part_of(twist_about(child, bone.axis), bone.child_twist);
      }
    }
    // Parent and joint agree on where the joint is, and so does what is between them.
    transforms.push_back({rotation, pose.position[joint] - rotation * skeleton_.joints[joint].rest_position});
  }
  return transforms;
}

}  // namespace reprise::body
