// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/sequence_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/core/text.h"
#include "reprise/io/frame_writers.h"
#include "reprise/io/gltf_writer.h"
#include "reprise/io/image_file.h"
#include "reprise/io/output_file.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

// ---- A folder of frames
// ---------------------------------------------------------------------------------------

std::string file_name_stem(const std::string& sequence_name) {
  std::string stem = sequence_name.empty() ? "frame" : sequence_name;
  for (char& c : stem) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) == 0 && c != '-' && c != '.' && byte < 128) c = '_';
  }
  return stem;
}

std::string frame_file_name(const std::string& stem, std::size_t frame_idx, const char* extension) {
  return fmt::format("{}_{:05}{}", stem, frame_idx, extension);
}

bool is_frame_name(const std::string& name, std::string_view extension) {
  if (!name.ends_with(extension)) return false;
  const std::string_view stem = std::string_view(name).substr(0, name.size() - extension.size());
  const std::size_t underscore = stem.rfind('_');
  if (underscore == std::string_view::npos || underscore == 0) return false;
  const std::string_view digits = stem.substr(underscore + 1);
  return !digits.empty() && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
}

// A folder may be replaced if everything in it is NAME_DIGITS of the same format and carries our mark, or
// belongs to such files. Captures are often named the same way, so the name alone is not enough.
bool is_of_earlier_export(const fs::directory_entry& entry, const char* extension) {
  if (!entry.is_regular_file() || entry.is_symlink()) return false;
  const std::string name = entry.path().filename().string();
  if (is_frame_name(name, extension)) return is_exported_frame(entry.path());
  if (name.ends_with(".mtl")) return is_exported_frame(entry.path());
  const std::string texture_end = texture_file_name("");
  if (!name.ends_with(texture_end)) return false;
  const std::string stem = name.substr(0, name.size() - texture_end.size());
  return is_exported_frame(entry.path().parent_path() / frame_file_name(stem, 0, extension));
}

void check_replaceable(const fs::path& folder, const char* extension) {
  if (!fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!is_of_earlier_export(entry, extension)) {
      throw FileError(folder,
                      fmt::format("is left as it is: it holds '{}', which is not a frame of an earlier "
                                  "export; expected a new folder or frames named NAME_00000{}",
                                  entry.path().filename().string(), extension));
    }
  }
}

// `reported`: what errors call the file.
template <typename Bytes>
void write_file(const fs::path& path, const fs::path& reported, const Bytes& bytes) {
  OutputFile file(path, reported);
  file.write_values(std::span(bytes));
  file.finish();
}

void write_folder(const MeshSequence& sequence, const fs::path& target, const char* extension,
                  const std::map<std::string, std::string>& files_beside,
                  const std::function<std::string(std::size_t)>& frame_bytes) {
  AtomicOutput output(target, AtomicOutput::Kind::directory);
  check_replaceable(output.target(), extension);
  const std::string stem = file_name_stem(sequence.name());
  Progress progress("writing", sequence.frame_count());
  parallel_for(0, sequence.frame_count(), [&](std::size_t f) {
    const std::string name = frame_file_name(stem, f, extension);
    write_file(output.path() / name, output.target() / name, frame_bytes(f));
    progress.advance();
  });
  for (const auto& [name, bytes] : files_beside)
    write_file(output.path() / name, output.target() / name, bytes);
  output.commit();
}

// ---- Point caches
// ---------------------------------------------------------------------------------------------

float swap_bytes(float value) {
  return std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
}

// "POINTCACHE2\0", then version 1, vertices, first frame 0, 1 scene frame a sample, samples; positions
// little-endian.
void write_pc2(const MeshSequence& sequence, OutputFile& file, Progress& progress) {
  std::array<char, 32> header{};
  const auto put = [&](std::size_t offset, auto value) {
    std::memcpy(header.data() + offset, &value, sizeof value);
  };
  std::memcpy(header.data(), "POINTCACHE2", 12);
  put(12, std::int32_t{1});
  put(16, static_cast<std::int32_t>(sequence.vertex_count()));
  put(20, 0.0F);
  put(24, 1.0F);
  put(28, static_cast<std::int32_t>(sequence.frame_count()));
  file.write({header.data(), header.size()});
  for (std::size_t f = 0; f < sequence.frame_count(); ++f) {
    file.write_values(std::span(sequence.frame(f).data(), sequence.vertex_count() * 3));
    progress.advance();
  }
}

// Samples, vertices, times in seconds, positions, all big-endian.
void write_mdd(const MeshSequence& sequence, OutputFile& file, Progress& progress) {
  std::vector<float> values = {std::bit_cast<float>(static_cast<std::int32_t>(sequence.frame_count())),
                               std::bit_cast<float>(static_cast<std::int32_t>(sequence.vertex_count()))};
  for (std::size_t f = 0; f < sequence.frame_count(); ++f) {
    values.push_back(static_cast<float>(static_cast<double>(f) / sequence.frames_per_second()));
  }
  std::ranges::transform(values, values.begin(), swap_bytes);
  file.write_values(std::span<const float>(values));
  values.resize(sequence.vertex_count() * 3);
  for (std::size_t f = 0; f < sequence.frame_count(); ++f) {
    std::transform(sequence.frame(f).data(), sequence.frame(f).data() + values.size(), values.begin(),
                   swap_bytes);
    file.write_values(std::span<const float>(values));
    progress.advance();
  }
}

void write_cache(const MeshSequence& sequence, const fs::path& target, SequenceFormat format,
                 const SequenceWriteOptions& options, SequenceWriteReport& report) {
  AtomicOutput output(target, AtomicOutput::Kind::file);
  std::optional<AtomicOutput> topology;
  std::optional<AtomicOutput> texture;
  if (options.write_topology) {
    const fs::path beside = fs::path(output.target()).replace_extension(".ply");
    if (fs::is_regular_file(beside) && !is_exported_frame(beside)) {
      throw FileError(beside,
                      "is left as it is: it is not of an earlier export; move it, choose another name, or "
                      "write no topology");
    }
    topology.emplace(beside, AtomicOutput::Kind::file);
    std::string texture_name;
    if (sequence.topology()->texture) {
      texture_name = texture_file_name(beside.stem().string());
      const fs::path path = beside.parent_path() / texture_name;
      if (fs::exists(path) && !is_exported_frame(beside, texture_name)) {
        throw FileError(path,
                        "is left as it is: it is not of an earlier export; move it or choose another name");
      }
      texture.emplace(path, AtomicOutput::Kind::file);
      write_file(texture->path(), path, encode_png(*sequence.topology()->texture));
      report.files_beside.push_back(path);
    }
    write_file(topology->path(), beside, PlyFrameWriter(sequence, true, texture_name).bytes(0));
    report.files_beside.push_back(beside);
  }
  {
    OutputFile file(output.path(), output.target());
    Progress progress("writing", sequence.frame_count());
    if (format == SequenceFormat::pc2) {
      write_pc2(sequence, file, progress);
    } else {
      write_mdd(sequence, file, progress);
    }
    file.finish();
  }
  if (texture) texture->commit();
  if (topology) topology->commit();
  output.commit();
}

struct FormatName {
  const char* name;
  SequenceFormat format;
};
constexpr std::array<FormatName, 6> format_names = {{{"obj", SequenceFormat::obj},
                                                     {"ply", SequenceFormat::ply},
                                                     {"pc2", SequenceFormat::pc2},
                                                     {"mdd", SequenceFormat::mdd},
                                                     {"glb", SequenceFormat::gltf},
                                                     {"gltf", SequenceFormat::gltf}}};

}  // namespace

SequenceWriteReport write_sequence(const MeshSequence& sequence, const fs::path& target,
                                   SequenceFormat format, const SequenceWriteOptions& options) {
  if (!sequence.topology() || sequence.frame_count() == 0) {
    throw InvalidArgument(fmt::format("sequence '{}' has no frames to write", sequence.name()));
  }
  SequenceWriteReport report{.path = target, .frames_written = sequence.frame_count()};
  const bool has_texture = sequence.topology()->texture != nullptr;
  const std::string stem = file_name_stem(sequence.name());
  std::map<std::string, std::string> files_beside;  // of the frames in a folder
  if (has_texture && (format == SequenceFormat::obj || format == SequenceFormat::ply)) {
    const std::vector<std::byte> png = encode_png(*sequence.topology()->texture);
    files_beside[texture_file_name(stem)] = {reinterpret_cast<const char*>(png.data()), png.size()};
  }
  switch (format) {
    case SequenceFormat::obj: {
      const ObjFrameWriter writer(sequence, has_texture ? material_file_name(stem) : "");
      if (has_texture) files_beside[material_file_name(stem)] = material_text(texture_file_name(stem));
      write_folder(sequence, target, ".obj", files_beside, [&](std::size_t f) { return writer.text(f); });
      break;
    }
    case SequenceFormat::ply: {
      const PlyFrameWriter writer(sequence, options.binary_ply, has_texture ? texture_file_name(stem) : "");
      write_folder(sequence, target, ".ply", files_beside, [&](std::size_t f) { return writer.bytes(f); });
      break;
    }
    case SequenceFormat::pc2:
    case SequenceFormat::mdd:
      write_cache(sequence, target, format, options, report);
      break;
    case SequenceFormat::gltf:
      write_gltf(sequence, target, options, report);
      break;
  }
  return report;
}

std::string file_extension(SequenceFormat format) {
  switch (format) {
    case SequenceFormat::gltf:
      return ".glb";
    case SequenceFormat::pc2:
      return ".pc2";
    case SequenceFormat::mdd:
      return ".mdd";
    case SequenceFormat::obj:
    case SequenceFormat::ply:
      break;
  }
  return {};
}

SequenceFormat parse_sequence_format(const std::string& name, const fs::path& target) {
  std::string word = name.empty() ? target.extension().string() : name;
  if (name.empty() && !word.empty()) word.erase(0, 1);
  std::ranges::transform(word, word.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty() && word == "gltf") {
    throw InvalidArgument(
        fmt::format("glTF is written as one binary file: expected a name ending in .glb, not '{}'",
                    target.filename().string()));
  }
  for (const auto& [format_name, format] : format_names) {
    if (word == format_name) return format;
  }
  constexpr const char* expected = "expected one of obj, ply, pc2, mdd, glb";
  if (name.empty()) {
    throw InvalidArgument(
        fmt::format("the format does not follow from the name '{}': {}", target.string(), expected));
  }
  const std::vector<std::string> known = {"obj", "ply", "pc2", "mdd", "glb"};
  const std::string nearest = nearest_word(word, known);
  throw InvalidArgument(fmt::format("'{}' is not a format: {}{}", name, expected,
                                    nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
}

}  // namespace reprise
