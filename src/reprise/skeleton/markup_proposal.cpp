// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/markup_proposal.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/database/body_parts.h"
#include "reprise/skeleton/surface_loop.h"

namespace reprise {
namespace {

using skeleton::LoopFinder;

// Order of the tips that loops separate from the top of the head.
enum Terminal : std::uint32_t {
  left_hand = 1,
  right_hand = 2,
  left_toe = 4,
  right_toe = 8,
  all_terminals = 15
};
constexpr std::array<const char*, 4> terminal_names = {"left_hand", "right_hand", "left_toe", "right_toe"};

// Where bones of the trunk and head begin, as shares of the way between the joints that landmarks give: means
// of adult bodies, which differ by a few centimetres.
constexpr double pelvis_share = 0.04;  // from between the hips to the neck
constexpr double spine_share = 0.26;
constexpr double chest_share = 0.52;
constexpr double head_share = 0.25;  // from the neck to the top of the head
constexpr double toe_share = 0.30;   // of the way over the surface from the tip of the toes to the ankle
// The ring of a shoulder runs from its top to the armpit, that of a hip from its outer side to the crotch:
// both centroids lie below the joint. A shoulder is nearer to its top, and a hip as high as the landmark.
constexpr double shoulder_share = 0.5;  // from the landmark to the centroid
constexpr double collar_share = 0.15;   // from between the shoulders to the shoulder

void check(const Mesh& mesh, const Landmarks& landmarks) {
  const std::vector<std::string>& names = landmark_names();
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (!landmarks.contains(name)) missing.push_back(name);
  }
  for (const auto& [name, vertex] : landmarks) {
    if (std::ranges::find(names, name) == names.end()) {
      const std::string nearest = nearest_word(name, names);
      throw InvalidArgument(fmt::format("there is no landmark '{}'{}; expected {}", name,
                                        nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                                        fmt::join(names, ", ")));
    }
    if (vertex < 0 || vertex >= mesh.topology->vertex_count) {
      throw InvalidArgument(fmt::format("landmark '{}' is vertex {}, but there are {} vertices", name, vertex,
                                        mesh.topology->vertex_count));
    }
  }
  if (!missing.empty()) {
    throw InvalidArgument(fmt::format("landmarks are missing: {}; expected {}", fmt::join(missing, ", "),
                                      fmt::join(names, ", ")));
  }
  for (auto one = landmarks.begin(); one != landmarks.end(); ++one) {
    for (auto other = std::next(one); other != landmarks.end(); ++other) {
      if (one->second == other->second) {
        throw InvalidArgument(fmt::format("landmarks '{}' and '{}' are the same vertex {}", one->first,
                                          other->first, one->second));
      }
    }
  }
}

class Proposal {
 public:
  Proposal(const Mesh& mesh, const Landmarks& landmarks)
      : mesh_(mesh),
        landmarks_(landmarks),
        positions_(mesh.positions.data(), mesh.positions.rows(), 3),
        loops_(*mesh.topology, positions_, landmarks.at("head_top"), terminals(landmarks)),
        label_(static_cast<std::size_t>(mesh.topology->vertex_count), -1) {}

  Markup make() {
    Markup markup;
    make_trunk();
    make_collars();
    for (const bool is_left : {true, false}) {
      const std::string side = is_left ? "left_" : "right_";
      make_limb(side, {"shoulder", "elbow", "wrist", "hand"}, {"upper_arm", "forearm", "hand"},
                side + "collar");
      make_limb(side, {"hip", "knee", "ankle", "toe"}, {"thigh", "shin", "foot"}, "pelvis");
      make_toes(side);
    }
    markup.skeleton = skeleton_;
    markup.reference = mesh_.positions;
    markup.joint_of_vertex = label_;
    markup.parts = body_parts(*mesh_.topology, mesh_.positions, skeleton_, label_);
    return markup;
  }

 private:
  static std::vector<std::int32_t> terminals(const Landmarks& landmarks) {
    std::vector<std::int32_t> vertices;
    for (const char* name : terminal_names) vertices.push_back(landmarks.at(name));
    return vertices;
  }

  Eigen::Vector3d point(std::int32_t vertex) const {
    return positions_.row(vertex).transpose().cast<double>();
  }

  int add_joint(const std::string& name, const std::string& parent, const Eigen::Vector3d& position) {
    skeleton_.joints.push_back({.name = name,
                                .parent = parent.empty() ? -1 : skeleton_.joint_idx(parent),
                                .rest_position = position});
    return skeleton_.size() - 1;
  }

  // The ring around a limb at a landmark, and what lies beyond it.
  struct Cut {
    Eigen::Vector3d centre;
    std::vector<bool> beyond;
  };
  Cut cut(const std::string& landmark, std::uint32_t separated, const std::string& tip,
          const std::string& trunk) const {
    const std::vector<float> from_tip = loops_.graph().distances(std::array{landmarks_.at(tip)});
    const auto way = [&](const std::string& name) {
      return from_tip[static_cast<std::size_t>(landmarks_.at(name))];
    };
    if (way(landmark) >= way(trunk)) {
      throw InvalidArgument(
          fmt::format("landmark '{}' (vertex {}) is farther from '{}' than '{}' is; is it on the right limb?",
                      landmark, landmarks_.at(landmark), tip, trunk));
    }
    const std::vector<std::int32_t> loop =
        loops_.loop(landmarks_.at(landmark), separated, landmarks_.at(tip));
    Cut made;
    if (!loop.empty()) {
      made.centre = loops_.centroid(loop);
      made.beyond = loops_.beyond(loop, landmarks_.at(tip));
    }
    if (loop.empty() || made.beyond[static_cast<std::size_t>(landmarks_.at(trunk))]) {
      throw InvalidArgument(
          fmt::format("landmark '{}' (vertex {}): no ring through it separates '{}' from '{}'; is it on the "
                      "right limb, and is "
                      "the surface closed and not grown together there?",
                      landmark, landmarks_.at(landmark), tip, trunk));
    }
    return made;
  }

  void label(const std::vector<bool>& vertices, int joint) {
    for (std::size_t v = 0; v < label_.size(); ++v) {
      if (vertices[v]) label_[v] = joint;
    }
  }

  void make_trunk() {
    const Cut left = cut("left_hip", left_toe, "left_toe", "head_top");
    const Cut right = cut("right_hip", right_toe, "right_toe", "head_top");
    const Cut neck = cut("neck", all_terminals, "head_top", "left_hand");
    const Eigen::Vector3d axis = (neck.centre - 0.5 * (left.centre + right.centre)).normalized();
    for (const auto& [landmark, centre] : {std::pair("left_hip", left.centre), {"right_hip", right.centre}}) {
      trunk_joint_[landmark] = centre + (point(landmarks_.at(landmark)) - centre).dot(axis) * axis;
    }
    const Eigen::Vector3d hips = 0.5 * (trunk_joint_.at("left_hip") + trunk_joint_.at("right_hip"));
    const Eigen::Vector3d up = neck.centre - hips;
    const Eigen::Vector3d top = point(landmarks_.at("head_top"));
    if (up.norm() < 1e-6) throw InvalidArgument("landmarks 'neck' and the hips are at one place");
    const int pelvis = add_joint("pelvis", "", hips + pelvis_share * up);
    const int spine = add_joint("spine", "pelvis", hips + spine_share * up);
    const int chest = add_joint("chest", "spine", hips + chest_share * up);
    const int neck_joint = add_joint("neck", "chest", neck.centre);
    const int head = add_joint("head", "neck", neck.centre + head_share * (top - neck.centre));
    const auto share = [&](std::size_t v, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
      return (point(static_cast<std::int32_t>(v)) - from).dot(way) / way.squaredNorm();
    };
    for (std::size_t v = 0; v < label_.size(); ++v) {
      if (neck.beyond[v]) {
        label_[v] = share(v, neck.centre, top - neck.centre) < head_share ? neck_joint : head;
      } else {
        const double height = share(v, hips, up);
        label_[v] = height < spine_share ? pelvis : height < chest_share ? spine : chest;
      }
    }
  }

  // Shoulders are raised and drawn forward on collar bones, which no vertex of their own shows.
  void make_collars() {
    constexpr std::array<std::pair<const char*, const char*>, 2> sides = {
        {{"left_shoulder", "left_hand"}, {"right_shoulder", "right_hand"}}};
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& [landmark, tip] : sides) {
      const Eigen::Vector3d centre = cut(landmark, bit_of(tip), tip, "head_top").centre;
      const Eigen::Vector3d top = point(landmarks_.at(landmark));
      trunk_joint_[landmark] = top + shoulder_share * (centre - top);
      middle += 0.5 * trunk_joint_[landmark];
    }
    add_joint("left_collar", "chest", middle + collar_share * (trunk_joint_["left_shoulder"] - middle));
    add_joint("right_collar", "chest", middle + collar_share * (trunk_joint_["right_shoulder"] - middle));
  }

  static std::uint32_t bit_of(const std::string& tip) {
    return std::uint32_t{1} << (std::ranges::find(terminal_names, tip) - terminal_names.begin());
  }

  // `landmarks`: of three joints and the tip. Later bones take from the earlier ones what lies beyond them.
  void make_limb(const std::string& side, const std::array<const char*, 4>& landmarks,
                 const std::array<const char*, 3>& joints, const std::string& trunk) {
    const std::string tip = side + landmarks[3];
    const std::uint32_t bit = bit_of(tip);
    std::string parent = trunk;
    std::string inner = "head_top";
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const std::string name = side + joints[i];
      const std::string landmark = side + landmarks[i];
      const Cut made = cut(landmark, bit, tip, inner);
      const auto known = trunk_joint_.find(landmark);
      const Eigen::Vector3d position = known != trunk_joint_.end() ? known->second : made.centre;
      label(made.beyond, add_joint(name, parent, position));
      parent = name;
      inner = landmark;
    }
  }

  // The toes bend where no landmark is: at a fixed share of the way to the ankle.
  void make_toes(const std::string& side) {
    const std::int32_t tip = landmarks_.at(side + "toe");
    const std::int32_t ankle = landmarks_.at(side + "ankle");
    const std::vector<float> distance = loops_.graph().distances(std::array{tip});
    const float limit = static_cast<float>(toe_share) * distance[static_cast<std::size_t>(ankle)];
    const int foot = skeleton_.joint_idx(side + "foot");
    Eigen::Vector3d ring = Eigen::Vector3d::Zero();
    int crossings = 0;
    for (std::size_t v = 0; v < label_.size(); ++v) {
      if (label_[v] != foot || distance[v] > limit) continue;
      for (const auto& [u, length] : loops_.graph().neighbours(static_cast<std::int32_t>(v))) {
        const float beyond = distance[static_cast<std::size_t>(u)];
        if (beyond <= limit) continue;
        const double share = (limit - distance[v]) / (beyond - distance[v]);
        ring += (1.0 - share) * point(static_cast<std::int32_t>(v)) + share * point(u);
        ++crossings;
      }
    }
    if (crossings == 0) {
      throw InvalidArgument(fmt::format("landmarks '{0}toe' and '{0}ankle' leave no room for toes", side));
    }
    const int toe = add_joint(side + "toe", side + "foot", ring / crossings);
    for (std::size_t v = 0; v < label_.size(); ++v) {
      if (label_[v] == foot && distance[v] <= limit) label_[v] = toe;
    }
  }

  const Mesh& mesh_;
  const Landmarks& landmarks_;
  PositionsView positions_;
  LoopFinder loops_;
  Skeleton skeleton_;
  std::map<std::string, Eigen::Vector3d> trunk_joint_;  // of hips and shoulders, by landmark
  std::vector<std::int32_t> label_;
};

}  // namespace

const std::vector<std::string>& landmark_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made = {"head_top", "neck"};
    for (const char* side : {"left", "right"}) {
      for (const char* place : {"shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle", "toe"}) {
        made.push_back(fmt::format("{}_{}", side, place));
      }
    }
    return made;
  }();
  return names;
}

Markup propose_markup(const Mesh& mesh, const Landmarks& landmarks) {
  if (!mesh.topology) throw InvalidArgument("the surface has no topology");
  if (mesh.positions.rows() != mesh.topology->vertex_count) {
    throw InvalidArgument(
        fmt::format("{} positions for {} vertices", mesh.positions.rows(), mesh.topology->vertex_count));
  }
  check(mesh, landmarks);
  return Proposal(mesh, landmarks).make();
}

}  // namespace reprise
