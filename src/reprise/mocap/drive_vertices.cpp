// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/drive_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/json_file.h"

namespace reprise {
namespace {

constexpr const char* file_format = "reprise drive vertices";
constexpr int format_version = 1;

// Root mean square distance from where the bone carries a vertex beyond which it is cloth or hair, metres.
constexpr double loose_residual = 0.006;
// Loose vertices nearer to others than this say nothing new, metres.
constexpr double least_spread = 0.01;

void check(const DriveVertexOptions& options) {
  if (options.per_bone < 1) {
    throw InvalidArgument(fmt::format("per_bone: expected 1 or more, found {}", options.per_bone));
  }
  if (!(options.rigid_share > 0.0 && options.rigid_share <= 1.0)) {
    throw InvalidArgument(
        fmt::format("rigid_share: expected a share above 0, up to 1; found {}", options.rigid_share));
  }
  if (options.loose < 0) {
    throw InvalidArgument(fmt::format("loose: expected 0 or more, found {}", options.loose));
  }
  for (const auto& [name, weight] :
       {std::pair("foot_weight", options.foot_weight), std::pair("loose_weight", options.loose_weight)}) {
    if (!(weight > 0.0) || !std::isfinite(weight)) {
      throw InvalidArgument(fmt::format("{}: expected a positive number, found {}", name, weight));
    }
  }
}

// Feet and what hangs on them.
std::vector<bool> foot_joints(const Skeleton& skeleton) {
  std::vector<bool> is_foot;
  for (const Joint& joint : skeleton.joints) {
    is_foot.push_back(joint.name == "left_foot" || joint.name == "right_foot" ||
                      (joint.parent >= 0 && is_foot[static_cast<std::size_t>(joint.parent)]));
  }
  return is_foot;
}

// Vertices chosen so far, and how far each candidate is from the nearest of them.
class FarthestPoints {
 public:
  FarthestPoints(const Positions& positions, std::vector<std::int32_t> candidates)
      : positions_(positions),
        candidates_(std::move(candidates)),
        squared_(candidates_.size(), std::numeric_limits<float>::infinity()) {}

  bool empty() const { return candidates_.empty(); }
  // The candidate farthest from all that were added (the first one of equals) and its distance, metres.
  std::pair<std::int32_t, double> farthest() const {
    const auto at = std::ranges::max_element(squared_) - squared_.begin();
    const auto idx = static_cast<std::size_t>(at);
    return {candidates_[idx], std::sqrt(static_cast<double>(squared_[idx]))};
  }
  void add(std::int32_t vertex) {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      squared_[i] =
          std::min(squared_[i], (positions_.row(candidates_[i]) - positions_.row(vertex)).squaredNorm());
    }
  }

 private:
  const Positions& positions_;
  std::vector<std::int32_t> candidates_;
  std::vector<float> squared_;
};

// `vertices` of one bone, all with residuals.
std::vector<std::int32_t> spread_rigid(std::vector<std::int32_t> vertices,
                                       const std::vector<double>& residuals, const Positions& reference,
                                       const DriveVertexOptions& options) {
  std::ranges::stable_sort(vertices, {},
                           [&](std::int32_t v) { return residuals[static_cast<std::size_t>(v)]; });
  const auto share =
      static_cast<std::size_t>(std::ceil(options.rigid_share * static_cast<double>(vertices.size())));
  const auto wanted = static_cast<std::size_t>(options.per_bone);
  vertices.resize(std::min(vertices.size(), std::max(share, wanted)));
  std::vector<std::int32_t> chosen = {vertices.front()};
  FarthestPoints candidates(reference, vertices);
  candidates.add(chosen.back());
  while (chosen.size() < wanted) {
    const auto [vertex, distance] = candidates.farthest();
    if (distance == 0.0) break;  // all are chosen
    chosen.push_back(vertex);
    candidates.add(vertex);
  }
  return chosen;
}

}  // namespace

std::vector<DriveVertex> choose_drive_vertices(const PerformanceDatabase& database,
                                               const SkeletonFollower& follower,
                                               const DriveVertexOptions& options) {
  check(options);
  if (!database.markup()) {
    throw InvalidArgument("drive vertices are chosen by bone: the database has no markup (reprise markup)");
  }
  const Markup& markup = *database.markup();
  const std::vector<double>& residuals = follower.residuals();
  if (residuals.size() != markup.joint_of_vertex.size()) {
    throw InvalidArgument(fmt::format("the skeleton was learnt on {} vertices; the database has {}",
                                      residuals.size(), markup.joint_of_vertex.size()));
  }
  std::vector<DriveVertex> chosen;
  const std::vector<bool> is_foot = foot_joints(markup.skeleton);
  for (int joint = 0; joint < markup.skeleton.size(); ++joint) {
    const std::vector<std::int32_t> vertices = markup.vertices_of_joint(joint);
    if (vertices.empty() || std::isinf(residuals[static_cast<std::size_t>(vertices.front())])) continue;
    const double weight = is_foot[static_cast<std::size_t>(joint)] ? options.foot_weight : 1.0;
    for (const std::int32_t v : spread_rigid(vertices, residuals, markup.reference, options)) {
      chosen.push_back({.vertex = v, .joint = joint, .weight = weight});
    }
  }

  std::vector<std::int32_t> loose;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    if (residuals[v] > loose_residual) loose.push_back(static_cast<std::int32_t>(v));
  }
  FarthestPoints candidates(markup.reference, std::move(loose));
  for (const DriveVertex& vertex : chosen) candidates.add(vertex.vertex);
  for (int i = 0; i < options.loose && !candidates.empty(); ++i) {
    const auto [vertex, distance] = candidates.farthest();
    if (distance < least_spread) break;
    chosen.push_back({.vertex = vertex, .joint = -1, .weight = options.loose_weight});
    candidates.add(vertex);
  }
  std::ranges::sort(chosen, {}, &DriveVertex::vertex);
  return chosen;
}

void write_drive_vertices(const std::vector<DriveVertex>& vertices, const Skeleton& skeleton,
                          const std::filesystem::path& path) {
  std::string text = fmt::format("{{\n  \"format\": {},\n  \"version\": {},\n  \"vertices\": [",
                                 Json(file_format).dump(), format_version);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const DriveVertex& vertex = vertices[i];
    if (vertex.joint >= skeleton.size()) {
      throw InvalidArgument(fmt::format("drive vertex {} has joint {}; the skeleton has {}", vertex.vertex,
                                        vertex.joint, skeleton.size()));
    }
    const std::string joint =
        vertex.joint < 0 ? "" : skeleton.joints[static_cast<std::size_t>(vertex.joint)].name;
    // One a line, as people edit them.
    const Json entry = {{"vertex", vertex.vertex}, {"joint", joint}, {"weight", vertex.weight}};
    text += fmt::format("{}\n    {}", i == 0 ? "" : ",",
                        entry.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  write_text_file(path, text + "\n  ]\n}\n");
}

std::vector<DriveVertex> read_drive_vertices(const std::filesystem::path& path,
                                             const PerformanceDatabase& database) {
  if (!database.markup()) {
    throw InvalidArgument("drive vertices name joints: the database has no markup (reprise markup)");
  }
  const Skeleton& skeleton = database.markup()->skeleton;
  const Json json = read_json_file(path);
  if (!json.is_object() || !json.contains("format") || json["format"] != file_format) {
    throw FileError(path,
                    fmt::format("is not a list of drive vertices: expected \"format\": \"{}\"", file_format));
  }
  const JsonField file(path, json);
  if (const int version = file["version"].integer(1); version > format_version) {
    file["version"].fail(
        fmt::format("the file has version {}, this program reads up to version {}", version, format_version));
  }
  file.warn_of_others({"format", "version", "vertices"});

  std::vector<DriveVertex> vertices;
  std::vector<bool> is_listed(static_cast<std::size_t>(database.topology()->vertex_count), false);
  for (const JsonField& item : file["vertices"].items()) {
    item.warn_of_others({"vertex", "joint", "weight"});
    DriveVertex vertex{.vertex = item["vertex"].integer(0, database.topology()->vertex_count - 1)};
    if (is_listed[static_cast<std::size_t>(vertex.vertex)]) {
      item["vertex"].fail(fmt::format("vertex {} stands in the list twice", vertex.vertex));
    }
    is_listed[static_cast<std::size_t>(vertex.vertex)] = true;
    if (item.has("joint") && !item["joint"].text().empty()) {
      try {
        vertex.joint = skeleton.joint_idx(item["joint"].text());
      } catch (const InvalidArgument& error) {
        item["joint"].fail(error.what());
      }
    }
    if (item.has("weight")) vertex.weight = item["weight"].number();
    if (!(vertex.weight > 0.0) || !std::isfinite(vertex.weight)) {
      item["weight"].fail(fmt::format("expected a positive number, found {}", vertex.weight));
    }
    vertices.push_back(vertex);
  }
  if (vertices.empty()) file["vertices"].fail("expected drive vertices, found none");
  std::ranges::sort(vertices, {}, &DriveVertex::vertex);
  return vertices;
}

}  // namespace reprise
