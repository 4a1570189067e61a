// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/inspect.h"

#include <algorithm>
#include <functional>
#include <map>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_file.h"
#include "reprise/io/sequence_reader.h"

namespace reprise {
namespace {

constexpr std::size_t most_findings_of_a_kind = 10;

class Findings {
 public:
  explicit Findings(ValidationReport& report) : report_(report) {}

  // `kind` groups findings of one sort: after the first few the rest are only counted.
  void add(Finding::Severity severity, const std::string& kind, const std::string& where,
           const std::string& what) {
    // Messages of file errors begin with the file, which `where` names already.
    const std::string bare = what.starts_with(where + ": ") ? what.substr(where.size() + 2) : what;
    if (++counts_[kind].total <= most_findings_of_a_kind) report_.findings.push_back({severity, where, bare});
    counts_[kind].severity = severity;
  }

  void summarise() {
    for (const auto& [kind, count] : counts_) {
      if (count.total > most_findings_of_a_kind) {
        report_.findings.push_back(
            {count.severity, kind,
             fmt::format("{} more of this kind", count.total - most_findings_of_a_kind)});
      }
    }
  }

 private:
  struct Count {
    std::size_t total = 0;
    Finding::Severity severity = Finding::Severity::warning;
  };
  ValidationReport& report_;
  std::map<std::string, Count> counts_;
};

void check_topology(const Topology& topology, const std::string& where, Findings& findings) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const auto& [a, b, c] : topology.triangles) {
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++uses[std::minmax(p, q)];
  }
  const auto open = std::ranges::count_if(uses, [](const auto& edge) { return edge.second == 1; });
  const auto crowded = std::ranges::count_if(uses, [](const auto& edge) { return edge.second > 2; });
  const auto warn = [&](const std::string& what) {
    findings.add(Finding::Severity::warning, "topology", where, what);
  };
  if (open > 0) warn(fmt::format("the surface is open: {} boundary edges", open));
  if (crowded > 0) warn(fmt::format("{} edges have more than two triangles", crowded));
  const ConnectedComponents components = connected_components(topology);
  if (components.count > 1) warn(fmt::format("the surface has {} connected components", components.count));
}

// Zero-area triangles, and vertices that jump since the frame before (`previous` may be empty).
void check_frame(const Mesh& mesh, const Positions& previous, const std::string& where, Findings& findings) {
  const PositionsView positions(mesh.positions.data(), mesh.positions.rows(), 3);
  const std::string bad = degeneracy(*mesh.topology, positions);
  if (!bad.empty()) {
    findings.add(Finding::Severity::error, "unusable frame", where, bad);
    return;
  }
  std::size_t flat = 0;
  for (const auto& [a, b, c] : mesh.topology->triangles) {
    const Eigen::Vector3f p = mesh.positions.row(a);
    const Eigen::Vector3f q = mesh.positions.row(b);
    const Eigen::Vector3f r = mesh.positions.row(c);
    if (!((q - p).cross(r - p).squaredNorm() > 0.0F)) ++flat;
  }
  if (flat > 0) {
    findings.add(Finding::Severity::warning, "zero-area triangles", where,
                 fmt::format("{} triangles have zero area", flat));
  }
  if (previous.rows() == mesh.positions.rows()) {
    const float size = (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
    Eigen::Index vertex = 0;
    const float farthest = (mesh.positions - previous).rowwise().norm().maxCoeff(&vertex);
    if (farthest > 0.5F * size) {
      findings.add(
          Finding::Severity::warning, "jump", where,
          fmt::format("vertex {} moves {:.3f} m since the frame before; the surface is {:.3f} m large",
                      vertex, farthest, size));
    }
  }
}

// Reads frames one after the other; a frame that cannot be read is an error and the next is looked at.
void check_frames(std::size_t frame_count, const std::function<Mesh(std::size_t)>& read,
                  const std::function<std::string(std::size_t)>& name, Findings& findings,
                  Progress& progress) {
  Positions previous;
  for (std::size_t f = 0; f < frame_count; ++f) {
    try {
      Mesh mesh = read(f);
      check_frame(mesh, previous, name(f), findings);
      previous = std::move(mesh.positions);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      findings.add(Finding::Severity::error, "unreadable frame", name(f), error.what());
      previous.resize(0, 3);
    }
    progress.advance();
  }
}

void validate_database(const std::filesystem::path& path, ValidationReport& report, Findings& findings) {
  const DatabaseReader reader(path);
  check_topology(*reader.topology(), path.string(), findings);
  for (const ClipInfo& clip : reader.clips()) report.frames += clip.frame_count;
  Progress progress("validate", report.frames);
  for (std::size_t c = 0; c < reader.clips().size(); ++c) {
    const ClipInfo& clip = reader.clips()[c];
    if (clip.frames_per_second != reader.clips().front().frames_per_second) {
      findings.add(Finding::Severity::warning, "rate", clip.name,
                   fmt::format("{} frames per second, but clip '{}' has {}", clip.frames_per_second,
                               reader.clips().front().name, reader.clips().front().frames_per_second));
    }
    check_frames(
        clip.frame_count, [&](std::size_t f) { return reader.read_frame(c, f); },
        [&](std::size_t f) { return fmt::format("{}:{}", clip.name, f); }, findings, progress);
  }
}

void validate_sequence(const std::filesystem::path& path, ValidationReport& report, Findings& findings) {
  const std::unique_ptr<SequenceReader> reader = open_sequence({.path = path});
  check_topology(*reader->topology(), reader->frame_name(0), findings);
  report.frames = reader->frame_count();
  Progress progress("validate", report.frames);
  check_frames(
      reader->frame_count(), [&](std::size_t f) { return reader->read(f); },
      [&](std::size_t f) { return reader->frame_name(f); }, findings, progress);
}

nlohmann::json describe_markup(const Markup& markup) {
  nlohmann::json joints = nlohmann::json::array();
  for (int j = 0; j < markup.skeleton.size(); ++j) {
    const Joint& joint = markup.skeleton.joints[static_cast<std::size_t>(j)];
    joints.push_back(
        {{"name", joint.name},
         {"parent",
          joint.parent < 0
              ? nlohmann::json()
              : nlohmann::json(markup.skeleton.joints[static_cast<std::size_t>(joint.parent)].name)},
         {"vertices", markup.vertices_of_joint(j).size()}});
  }
  nlohmann::json parts = nlohmann::json::array();
  for (const BodyPart& part : markup.parts) {
    nlohmann::json parent;
    if (part.parent >= 0) parent = markup.parts[static_cast<std::size_t>(part.parent)].name;
    parts.push_back({{"name", part.name}, {"parent", std::move(parent)}, {"vertices", part.vertices.size()}});
  }
  nlohmann::json layers = nlohmann::json::array();
  for (std::size_t l = 0; l < markup.layers.size(); ++l) {
    layers.push_back(
        {{"name", markup.layers[l]},
         {"vertices", std::ranges::count(markup.layer_of_vertex, static_cast<std::uint8_t>(l))}});
  }
  return {{"joints", std::move(joints)},
          {"unlabelled_vertices", markup.vertices_of_joint(-1).size()},
          {"parts", std::move(parts)},
          {"layers", std::move(layers)}};
}

nlohmann::json describe_model(const LearntModel& model) {
  nlohmann::json parts = nlohmann::json::array();
  for (const LearntPart& learnt : model.parts) {
    parts.push_back({{"name", learnt.part.name},
                     {"vertices", learnt.part.vertices.size()},
                     {"components", learnt.component_count()},
                     {"examples", learnt.examples.size()},
                     {"kept_variance", learnt.kept_variance()}});
  }
  return parts.empty() ? nlohmann::json() : nlohmann::json{{"parts", std::move(parts)}};
}

}  // namespace

nlohmann::json describe_database(const std::filesystem::path& database) {
  const DatabaseReader reader(database);
  nlohmann::json clips = nlohmann::json::array();
  std::size_t frames = 0;
  for (const ClipInfo& clip : reader.clips()) {
    frames += clip.frame_count;
    clips.push_back({{"name", clip.name},
                     {"frames", clip.frame_count},
                     {"frames_per_second", clip.frames_per_second},
                     {"seconds", static_cast<double>(clip.frame_count) / clip.frames_per_second},
                     {"colors", clip.has_colors},
                     {"normals", clip.has_normals},
                     {"provenance", clip.has_origins},
                     {"truth", clip.has_truth}});
  }
  const Topology& topology = *reader.topology();
  const LearntModels models = reader.read_models();
  return {{"path", database.string()},
          {"format_version", reader.format_version()},
          {"vertices", topology.vertex_count},
          {"triangles", topology.triangles.size()},
          {"texture_coordinates", topology.has_uvs()},
          {"texture", topology.texture ? nlohmann::json{{"width", topology.texture->width},
                                                        {"height", topology.texture->height}}
                                       : nlohmann::json()},
          {"markup", reader.markup() ? describe_markup(*reader.markup()) : nlohmann::json()},
          {"models", {{"part", describe_model(models.part)}, {"whole", describe_model(models.whole)}}},
          {"frames", frames},
          {"clips", std::move(clips)}};
}

bool ValidationReport::ok() const {
  return std::ranges::none_of(findings,
                              [](const Finding& f) { return f.severity == Finding::Severity::error; });
}

ValidationReport validate_path(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw FileError(path, "there is no such file or folder");
  ValidationReport report;
  Findings findings(report);
  if (path.extension() == ".reprise") {
    validate_database(path, report, findings);
  } else {
    try {
      validate_sequence(path, report, findings);
    } catch (const FileError& error) {  // the sequence cannot even be opened
      findings.add(Finding::Severity::error, "unusable sequence", path.string(), error.what());
    }
  }
  findings.summarise();
  return report;
}

}  // namespace reprise
