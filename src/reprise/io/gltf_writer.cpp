// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/gltf_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/io/frame_thinning.h"
#include "reprise/io/frame_writers.h"
#include "reprise/io/image_file.h"
#include "reprise/io/output_file.h"
#include "reprise/io/uv_seams.h"

namespace reprise {

using nlohmann::json;

namespace {

// Constants of the glTF specification.
enum ComponentType { int8 = 5120, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };
enum BufferTarget { vertex_data = 34962, index_data = 34963, other_data = 0 };

struct Bounds {
  std::array<float, 3> low = {0, 0, 0};
  std::array<float, 3> high = {0, 0, 0};
};

Bounds bounds(std::span<const float> values) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Bounds result{.low = {infinity, infinity, infinity}, .high = {-infinity, -infinity, -infinity}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.low[i % 3] = std::min(result.low[i % 3], values[i]);
    result.high[i % 3] = std::max(result.high[i % 3], values[i]);
  }
  return result;
}

// The binary part of the file and the JSON that describes it.
class Buffer {
 public:
  // Adds data as one buffer view; `stride`: bytes from element to element, 0 for data that is not of
  // vertices.
  std::size_t add_view(std::string bytes, BufferTarget target, std::size_t stride = 0) {
    json view = {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}};
    if (target != other_data) view["target"] = target;
    if (stride > 0) view["byteStride"] = stride;
    views_.push_back(std::move(view));
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    size_ += bytes.size();
    parts_.push_back(std::move(bytes));
    return views_.size() - 1;
  }

  std::size_t add_accessor(std::size_t view, ComponentType component, const char* type, std::size_t count,
                           bool normalized = false) {
    json accessor = {{"bufferView", view}, {"componentType", component}, {"type", type}, {"count", count}};
    if (normalized) accessor["normalized"] = true;
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }
  json& accessor(std::size_t idx) { return accessors_[idx]; }

  std::size_t size() const { return size_; }
  const std::vector<std::string>& parts() const { return parts_; }
  const json& views() const { return views_; }
  const json& accessors() const { return accessors_; }

 private:
  std::vector<std::string> parts_;
  json views_ = json::array();
  json accessors_ = json::array();
  std::size_t size_ = 0;
};

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

// The linear value of an sRGB channel, as 16 bits.
const std::array<std::uint16_t, 256>& linear_channels() {
  static const std::array<std::uint16_t, 256> table = [] {
    std::array<std::uint16_t, 256> result{};
    for (std::size_t i = 0; i < 256; ++i) {
      const double c = static_cast<double>(i) / 255.0;
      const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
      result[i] = static_cast<std::uint16_t>(std::lround(linear * 65535.0));
    }
    return result;
  }();
  return table;
}

// How numbers of the sequence become numbers of the file.
struct Coding {
  bool quantize = false;
  double scale = 1.0;                                // metres a step
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // metres at step 0
  // All base normals are (1, 1, 1) / sqrt(3), and the first frame has a target too.
  bool neutral_normals = false;
};

// Length of the normals that targets make of neutral ones: the longest for which every direction differs from
// the neutral one by at most 1 in each coordinate.
constexpr float neutral_reach = 0.42F;

std::int8_t normal_step(float value) {
  return static_cast<std::int8_t>(std::lround(std::clamp(value, -1.0F, 1.0F) * 127.0F));
}

class GltfWriter {
 public:
  GltfWriter(const MeshSequence& sequence, const SequenceWriteOptions& options)
      : sequence_(sequence),
        options_(options),
        vertex_count_(sequence.vertex_count()),
        cut_(cut_at_seams(*sequence.topology())),
        // The first frame is the mesh itself; a quantised clip may need a target for it too.
        kept_(thin_frames(sequence,
                          static_cast<std::size_t>(options.max_morph_targets) + (options.quantize ? 0 : 1))) {
    check();
    is_linear_ = options.interpolate || kept_.size() < sequence.frame_count();
    normals_.resize(kept_.size());
    parallel_for(0, kept_.size(), [&](std::size_t i) {
      throw_if_interrupted();
      normals_[i] = unit_normals(kept_[i]);
    });
    if (options.quantize) choose_coding();
    has_changing_colors_ = changing_colors();
  }

  void write(OutputFile& file) {
    json document = describe();
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + text.size() + 8 + buffer_.size();
    const auto put = [&](std::uint64_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      file.write_values(std::span(&word, 1));
    };
    for (const std::uint64_t word : {std::uint64_t{0x46546C67}, std::uint64_t{2}, total})
      put(word);  // "glTF"
    put(text.size());
    put(0x4E4F534A);  // "JSON"
    file.write(text);
    put(buffer_.size());
    put(0x004E4942);  // "BIN"
    for (const std::string& part : buffer_.parts()) {
      throw_if_interrupted();
      file.write(part);
    }
  }

  std::size_t file_bytes_estimate() const {
    const std::size_t per_vertex = options_.quantize ? 12 : 24;
    return (per_vertex + (has_changing_colors_ ? 8 : 0)) * cut_.source_vertices.size() * kept_.size() +
           20 * cut_.source_vertices.size() + 4 * kept_.size() * kept_.size() +
           12 * sequence_.topology()->triangles.size() +
           (sequence_.topology()->texture ? sequence_.topology()->texture->rgb.size() : 0);
  }

  const std::vector<std::size_t>& kept() const { return kept_; }

  // Largest distance between a vertex as it plays at the time of any frame of the sequence and as it was.
  double max_error() const {
    std::vector<double> errors(sequence_.frame_count(), 0.0);
    parallel_for(0, kept_.size(), [&](std::size_t i) {
      throw_if_interrupted();
      const Positions from = decoded(i);
      const std::size_t first = kept_[i];
      const std::size_t last = i + 1 < kept_.size() ? kept_[i + 1] : first + 1;
      const Positions to = last > first + 1 ? decoded(i + 1) : from;
      for (std::size_t f = first; f < last; ++f) {
        const auto t = static_cast<float>(f - first) / static_cast<float>(last - first);
        const double squared =
            ((1.0F - t) * from + t * to - sequence_.frame(f)).rowwise().squaredNorm().maxCoeff();
        errors[f] = std::sqrt(squared);
      }
    });
    return *std::ranges::max_element(errors);
  }

 private:
  void check() const {
    if (sequence_.topology()->triangles.empty()) {
      throw InvalidArgument(
          fmt::format("sequence '{}' has no triangles, which glTF needs", sequence_.name()));
    }
    for (std::size_t f = 0; f < sequence_.frame_count(); ++f) {
      const auto frame = sequence_.frame(f);
      if (frame.allFinite()) continue;
      Eigen::Index v = 0;
      while (frame.row(v).allFinite()) ++v;
      throw InvalidArgument(
          fmt::format("sequence '{}': vertex {} of frame {} is ({}, {}, {}), which glTF cannot hold",
                      sequence_.name(), v, f, frame(v, 0), frame(v, 1), frame(v, 2)));
    }
  }

  // glTF allows unit normals alone: vertices without one get the direction up.
  Positions unit_normals(std::size_t frame_idx) const {
    Positions normals = export_normals(sequence_, frame_idx);
    for (Eigen::Index v = 0; v < normals.rows(); ++v) {
      const double length = normals.row(v).cast<double>().norm();
      if (length > 1e-12 && std::isfinite(length)) {
        normals.row(v) = (normals.row(v).cast<double>() / length).cast<float>();
      } else {
        normals.row(v) << 0.0F, 1.0F, 0.0F;
      }
    }
    return normals;
  }

  void choose_coding() {
    coding_.quantize = true;
    const auto base = sequence_.frame(0);
    float turn = 0.0F;
    float travel = 0.0F;
    for (std::size_t i = 1; i < kept_.size(); ++i) {
      turn = std::max(turn, (normals_[i] - normals_[0]).cwiseAbs().maxCoeff());
      travel = std::max(travel, (sequence_.frame(kept_[i]) - base).cwiseAbs().maxCoeff());
    }
    coding_.neutral_normals = turn > 1.0F;
    const Eigen::Vector3d low = base.colwise().minCoeff().transpose().cast<double>();
    const Eigen::Vector3d high = base.colwise().maxCoeff().transpose().cast<double>();
    coding_.center = (low + high) / 2.0;
    // Two steps short of the largest integer, for the rounding of base and difference.
    constexpr double steps = 32765.0;
    const double reach = std::max((high - low).maxCoeff() / 2.0, static_cast<double>(travel));
    coding_.scale = reach > 0.0 ? reach / steps : 1.0;
  }

  // Steps of one vertex coordinate in the base, and of its difference in kept frame `i`.
  std::int16_t base_step(Eigen::Index v, Eigen::Index axis) const {
    return static_cast<std::int16_t>(std::lround(
        (static_cast<double>(sequence_.frame(0)(v, axis)) - coding_.center(axis)) / coding_.scale));
  }
  std::int16_t difference_step(std::size_t i, Eigen::Index v, Eigen::Index axis) const {
    const double position =
        (static_cast<double>(sequence_.frame(kept_[i])(v, axis)) - coding_.center(axis)) / coding_.scale;
    return static_cast<std::int16_t>(std::lround(position) - base_step(v, axis));
  }

  Positions differences(std::size_t i) const { return sequence_.frame(kept_[i]) - sequence_.frame(0); }

  // Positions of kept frame `i` as a viewer computes them.
  Positions decoded(std::size_t i) const {
    if (!coding_.quantize)
      return i == 0 ? Positions(sequence_.frame(0)) : Positions(sequence_.frame(0) + differences(i));
    Positions result(static_cast<Eigen::Index>(vertex_count_), 3);
    for (Eigen::Index v = 0; v < result.rows(); ++v) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double steps = base_step(v, axis) + (i == 0 ? 0.0 : difference_step(i, v, axis));
        result(v, axis) = static_cast<float>(steps * coding_.scale + coding_.center(axis));
      }
    }
    return result;
  }

  // The base mesh is the first kept frame and needs no target, unless its normals are neutral.
  std::size_t first_target() const { return coding_.neutral_normals ? 0 : 1; }
  std::size_t target_count() const { return kept_.size() - first_target(); }

  // Viewers multiply a texture with vertex colours.
  bool draws_colors() const { return sequence_.has_colors() && !sequence_.topology()->texture; }

  bool changing_colors() const {
    if (!draws_colors() || !sequence_.has_colors_per_frame()) return false;
    const auto first = sequence_.colors(0);
    return std::ranges::any_of(
        kept_, [&](std::size_t f) { return !std::ranges::equal(sequence_.colors(f), first); });
  }

  // ---- Vertex data: bytes in the order of the cut vertices, padded to the alignment of 4 that glTF demands
  // ----

  struct Attribute {
    std::string bytes;
    std::size_t stride = 0;
    Bounds bounds;
  };

  Attribute floats(const Positions& values) const {
    Attribute attribute{.stride = 12};
    attribute.bytes.reserve(12 * cut_.source_vertices.size());
    for (const std::int32_t v : cut_.source_vertices) append(attribute.bytes, values.row(v).data(), 3);
    attribute.bounds = bounds(std::span(values.data(), static_cast<std::size_t>(values.size())));
    return attribute;
  }

  template <typename T, typename Step>
  Attribute steps(const Step& step) const {
    Attribute attribute{.stride = 4 * sizeof(T)};
    attribute.bytes.reserve(attribute.stride * cut_.source_vertices.size());
    std::vector<float> values;
    values.reserve(3 * cut_.source_vertices.size());
    for (const std::int32_t v : cut_.source_vertices) {
      std::array<T, 4> row{};
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        row[static_cast<std::size_t>(axis)] = step(v, axis);
        values.push_back(static_cast<float>(row[static_cast<std::size_t>(axis)]));
      }
      append(attribute.bytes, row.data(), 4);
    }
    attribute.bounds = bounds(values);
    return attribute;
  }

  Attribute base_positions() const {
    if (!coding_.quantize) return floats(sequence_.frame(0));
    return steps<std::int16_t>([&](Eigen::Index v, Eigen::Index axis) { return base_step(v, axis); });
  }
  Attribute target_positions(std::size_t i) const {
    if (!coding_.quantize) return floats(differences(i));
    return steps<std::int16_t>(
        [&](Eigen::Index v, Eigen::Index axis) { return difference_step(i, v, axis); });
  }
  std::int8_t base_normal_step(Eigen::Index v, Eigen::Index axis) const {
    return normal_step(coding_.neutral_normals ? std::sqrt(1.0F / 3.0F) : normals_[0](v, axis));
  }
  Attribute base_normals() const {
    if (!coding_.quantize) return floats(normals_[0]);
    return steps<std::int8_t>([&](Eigen::Index v, Eigen::Index axis) { return base_normal_step(v, axis); });
  }
  Attribute target_normals(std::size_t i) const {
    if (!coding_.quantize) return floats(normals_[i] - normals_[0]);
    const float length = coding_.neutral_normals ? neutral_reach : 1.0F;
    return steps<std::int8_t>([&](Eigen::Index v, Eigen::Index axis) {
      const float base = static_cast<float>(base_normal_step(v, axis)) / 127.0F;
      return normal_step(length * normals_[i](v, axis) - base);
    });
  }

  // Colours as linear RGBA, or their differences to the base: 16 bits, normalised.
  std::string colors(std::size_t frame_idx) const {
    const auto& linear = linear_channels();
    const auto values = sequence_.colors(frame_idx);
    std::string bytes;
    bytes.reserve(8 * cut_.source_vertices.size());
    for (const std::int32_t v : cut_.source_vertices) {
      const Color& color = values[static_cast<std::size_t>(v)];
      const std::array<std::uint16_t, 4> row = {linear[color[0]], linear[color[1]], linear[color[2]], 65535};
      append(bytes, row.data(), 4);
    }
    return bytes;
  }
  std::string color_differences(std::size_t frame_idx) const {
    const auto& linear = linear_channels();
    const auto values = sequence_.colors(frame_idx);
    const auto base = sequence_.colors(0);
    std::string bytes;
    bytes.reserve(8 * cut_.source_vertices.size());
    for (const std::int32_t v : cut_.source_vertices) {
      std::array<std::int16_t, 4> row{};
      for (std::size_t c = 0; c < 3; ++c) {
        const int difference =
            linear[values[static_cast<std::size_t>(v)][c]] - linear[base[static_cast<std::size_t>(v)][c]];
        row[c] = static_cast<std::int16_t>(std::lround(difference * (32767.0 / 65535.0)));
      }
      append(bytes, row.data(), 4);
    }
    return bytes;
  }

  std::size_t add_positions(Attribute attribute) {
    const std::size_t view = buffer_.add_view(std::move(attribute.bytes), vertex_data, attribute.stride);
    const std::size_t accessor =
        buffer_.add_accessor(view, coding_.quantize ? int16 : float32, "VEC3", cut_.source_vertices.size());
    buffer_.accessor(accessor)["min"] = attribute.bounds.low;
    buffer_.accessor(accessor)["max"] = attribute.bounds.high;
    return accessor;
  }
  std::size_t add_normals(Attribute attribute) {
    const std::size_t view = buffer_.add_view(std::move(attribute.bytes), vertex_data, attribute.stride);
    return buffer_.add_accessor(view, coding_.quantize ? int8 : float32, "VEC3", cut_.source_vertices.size(),
                                coding_.quantize);
  }

  std::size_t add_indices() {
    std::string bytes;
    const bool is_short = cut_.source_vertices.size() < 65535;
    for (const Triangle& triangle : cut_.triangles) {
      for (const std::int32_t v : triangle) {
        if (is_short) {
          const auto index = static_cast<std::uint16_t>(v);
          append(bytes, &index, 1);
        } else {
          const auto index = static_cast<std::uint32_t>(v);
          append(bytes, &index, 1);
        }
      }
    }
    const std::size_t view = buffer_.add_view(std::move(bytes), index_data);
    return buffer_.add_accessor(view, is_short ? uint16 : uint32, "SCALAR", 3 * cut_.triangles.size());
  }

  json describe() {
    json primitive = {{"mode", 4}, {"material", 0}};
    primitive["indices"] = add_indices();
    primitive["attributes"]["POSITION"] = add_positions(base_positions());
    primitive["attributes"]["NORMAL"] = add_normals(base_normals());
    if (!cut_.uvs.empty()) primitive["attributes"]["TEXCOORD_0"] = add_uvs();
    if (draws_colors()) {
      const std::size_t view = buffer_.add_view(colors(0), vertex_data, 8);
      primitive["attributes"]["COLOR_0"] =
          buffer_.add_accessor(view, uint16, "VEC4", cut_.source_vertices.size(), true);
    }
    json names = json::array();
    if (target_count() > 0) {
      struct Target {
        Attribute positions;
        Attribute normals;
        std::string colors;
      };
      std::vector<Target> targets(kept_.size());
      parallel_for(first_target(), kept_.size(), [&](std::size_t i) {
        throw_if_interrupted();
        targets[i].positions = target_positions(i);
        targets[i].normals = target_normals(i);
        if (has_changing_colors_) targets[i].colors = color_differences(kept_[i]);
      });
      for (std::size_t i = first_target(); i < kept_.size(); ++i) {
        json target;
        target["POSITION"] = add_positions(std::move(targets[i].positions));
        target["NORMAL"] = add_normals(std::move(targets[i].normals));
        if (has_changing_colors_) {
          const std::size_t view = buffer_.add_view(std::move(targets[i].colors), vertex_data, 8);
          target["COLOR_0"] = buffer_.add_accessor(view, int16, "VEC4", cut_.source_vertices.size(), true);
        }
        primitive["targets"].push_back(std::move(target));
        names.push_back(fmt::format("frame_{:05}", kept_[i]));
      }
    }

    json mesh = {{"name", sequence_.name()}, {"primitives", json::array({std::move(primitive)})}};
    if (!names.empty()) mesh["extras"]["targetNames"] = std::move(names);
    if (coding_.neutral_normals) {  // what is seen while nothing plays
      std::vector<int> weights(target_count(), 0);
      weights.front() = 1;
      mesh["weights"] = weights;
    }
    if (cut_.has_copies(*sequence_.topology())) {
      mesh["extras"]["copied_vertices"] =
          std::vector<std::int32_t>(cut_.source_vertices.begin() + static_cast<std::ptrdiff_t>(vertex_count_),
                                    cut_.source_vertices.end());
    }
    json node = {{"name", sequence_.name()}, {"mesh", 0}};
    json document = {{"asset", {{"version", "2.0"}, {"generator", "Reprise"}}}, {"scene", 0}};
    if (coding_.quantize) {
      node["scale"] = {coding_.scale, coding_.scale, coding_.scale};
      node["translation"] = {coding_.center.x(), coding_.center.y(), coding_.center.z()};
      document["extensionsUsed"] = json::array({"KHR_mesh_quantization"});
      document["extensionsRequired"] = json::array({"KHR_mesh_quantization"});
    }
    document["scenes"] = json::array({{{"nodes", json::array({0})}}});
    document["nodes"] = json::array({std::move(node)});
    document["meshes"] = json::array({std::move(mesh)});
    json look = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.9}};
    if (sequence_.topology()->texture) add_texture(document, look);
    document["materials"] = json::array(
        {{{"name", "surface"}, {"doubleSided", true}, {"pbrMetallicRoughness", std::move(look)}}});
    if (kept_.size() > 1) document["animations"] = json::array({add_animation()});
    document["bufferViews"] = buffer_.views();
    document["accessors"] = buffer_.accessors();
    document["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
    return document;
  }

  void add_texture(json& document, json& look) {
    const std::vector<std::byte> png = encode_png(*sequence_.topology()->texture);
    std::string bytes;
    append(bytes, png.data(), png.size());
    document["images"] = json::array(
        {{{"bufferView", buffer_.add_view(std::move(bytes), other_data)}, {"mimeType", "image/png"}}});
    constexpr int linear = 9729;
    constexpr int linear_mipmap_linear = 9987;
    constexpr int repeat = 10497;
    document["samplers"] = json::array(
        {{{"magFilter", linear}, {"minFilter", linear_mipmap_linear}, {"wrapS", repeat}, {"wrapT", repeat}}});
    document["textures"] = json::array({{{"source", 0}, {"sampler", 0}}});
    look["baseColorTexture"] = {{"index", 0}};
  }

  std::size_t add_uvs() {
    std::string bytes;
    for (const auto& [u, v] : cut_.uvs) {
      const std::array<float, 2> uv = {u, 1.0F - v};
      append(bytes, uv.data(), 2);
    }
    return buffer_.add_accessor(buffer_.add_view(std::move(bytes), vertex_data, 8), float32, "VEC2",
                                cut_.uvs.size());
  }

  json add_animation() {
    std::vector<float> times;
    for (const std::size_t f : kept_) {
      times.push_back(static_cast<float>(static_cast<double>(f) / sequence_.frames_per_second()));
    }
    const std::size_t columns = target_count();
    std::vector<float> weights(kept_.size() * columns, 0.0F);
    for (std::size_t i = first_target(); i < kept_.size(); ++i)
      weights[i * columns + i - first_target()] = 1.0F;
    const auto add = [&](const std::vector<float>& values) {
      std::string bytes;
      append(bytes, values.data(), values.size());
      return buffer_.add_accessor(buffer_.add_view(std::move(bytes), other_data), float32, "SCALAR",
                                  values.size());
    };
    const std::size_t input = add(times);
    buffer_.accessor(input)["min"] = json::array({times.front()});
    buffer_.accessor(input)["max"] = json::array({times.back()});
    const json sampler = {
        {"input", input}, {"output", add(weights)}, {"interpolation", is_linear_ ? "LINEAR" : "STEP"}};
    const json channel = {{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
    return {{"name", sequence_.name()},
            {"samplers", json::array({sampler})},
            {"channels", json::array({channel})}};
  }

  const MeshSequence& sequence_;
  const SequenceWriteOptions& options_;
  std::size_t vertex_count_;
  SeamCut cut_;
  std::vector<std::size_t> kept_;
  bool is_linear_ = false;
  bool has_changing_colors_ = false;
  std::vector<Positions> normals_;  // of kept frames
  Coding coding_;
  Buffer buffer_;
};

}  // namespace

void write_gltf(const MeshSequence& sequence, const std::filesystem::path& target,
                const SequenceWriteOptions& options, SequenceWriteReport& report) {
  // A quantised clip may need a target for its first frame too.
  if (const int least = options.quantize ? 2 : 1; options.max_morph_targets < least) {
    throw InvalidArgument(
        fmt::format("max_morph_targets is {}; expected at least {}", options.max_morph_targets, least));
  }
  AtomicOutput output(target, AtomicOutput::Kind::file);
  GltfWriter writer(sequence, options);
  if (writer.file_bytes_estimate() > std::numeric_limits<std::uint32_t>::max()) {
    throw FileError(target,
                    fmt::format("would take {:.1f} GB; binary glTF holds 4 GB: keep fewer morph targets{} or "
                                "write a point cache",
                                static_cast<double>(writer.file_bytes_estimate()) * 1e-9,
                                options.quantize ? "" : ", quantise"));
  }
  OutputFile file(output.path(), output.target());
  writer.write(file);
  file.finish();
  report.frames_written = writer.kept().size();
  report.max_error = writer.max_error();
  if (report.frames_written < sequence.frame_count()) {
    spdlog::warn(
        "{}: {} of {} frames are kept, since viewers play at most {} morph targets; the others are "
        "interpolated and are off by up to {:.2g} m",
        target.filename().string(), report.frames_written, sequence.frame_count(), options.max_morph_targets,
        report.max_error);
  }
  output.commit();
}

}  // namespace reprise
