// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/markup.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/database/body_parts.h"
#include "reprise/io/database_file.h"
#include "reprise/io/markup_file.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/skeleton/markup_proposal.h"
#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise {
namespace {

Markup propose(const PerformanceDatabase& database, const MarkupOptions& options) {
  const LandmarkFile read = read_landmark_file(options.landmarks);
  const std::string& frame = options.frame.empty() ? read.frame : options.frame;
  if (frame.empty()) {
    throw FileError(
        options.landmarks,
        "names no frame on which the landmarks were chosen: expected \"frame\": \"CLIP:FRAME\", or "
        "name it with --frame");
  }
  const FrameId id = database.parse_frame(frame);
  try {
    Markup markup = propose_markup(database.clip(id.clip_idx).mesh(id.frame_idx), read.landmarks);
    if (!options.keep_joints) markup.skeleton = refine_joints(database.clips(), markup);
    return markup;
  } catch (const InvalidArgument& error) {
    throw FileError(options.landmarks, error.what());
  }
}

Markup new_markup(const PerformanceDatabase& database, const MarkupOptions& options) {
  Markup markup;
  if (!options.file.empty()) {
    markup = read_markup_file(options.file, database, options.frame);
  } else if (!options.landmarks.empty()) {
    markup = propose(database, options);
  } else if (database.markup()) {
    markup = *database.markup();
  } else {
    throw InvalidArgument(
        "the database has no markup whose joint labels could make parts: give landmarks or a file");
  }
  markup.parts = parts_of(*database.topology(), markup, options.parts);
  return markup;
}

std::size_t count_truths(const PerformanceDatabase& database) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < database.clips().size(); ++c) count += database.truth(c) != nullptr ? 1 : 0;
  return count;
}

}  // namespace

PartScheme parse_part_scheme(const std::string& text) {
  if (text == "six") return PartScheme::six;
  if (text == "limbs") return PartScheme::limbs;
  if (text == "whole") return PartScheme::whole;
  throw InvalidArgument(fmt::format("parts '{}': expected six, limbs or whole", text));
}

std::vector<BodyPart> parts_of(const Topology& topology, const Markup& markup, PartScheme scheme) {
  if (scheme == PartScheme::as_marked) return markup.parts;
  if (scheme == PartScheme::whole) return {whole_body_part(topology.vertex_count)};
  return body_parts(topology, markup.reference, markup.skeleton, markup.joint_of_vertex,
                    {.levels = scheme == PartScheme::limbs ? 2 : 1});
}

Markup mark_up(const std::filesystem::path& path, const MarkupOptions& options,
               const std::filesystem::path& output) {
  const bool is_new =
      !options.landmarks.empty() || !options.file.empty() || options.parts != PartScheme::as_marked;
  if (!options.landmarks.empty() && !options.file.empty()) {
    throw InvalidArgument("landmarks and a markup file are given: expected one of them");
  }
  if (is_new && output.empty()) throw InvalidArgument("a new markup needs a database to be written to");
  if (!is_new && !output.empty()) throw InvalidArgument("expected landmarks, a markup file or parts to make");
  if (!is_new && options.write_json.empty())
    throw InvalidArgument("nothing to do: neither new markup nor output");
  check_outputs({{output, ".reprise"}, {options.write_json, ".json"}},
                {path, options.landmarks, options.file});

  PerformanceDatabase database = load_database(path);
  if (is_new) {
    const std::size_t truths = count_truths(database);
    database.set_markup(new_markup(database, options));
    if (const std::size_t lost = truths - count_truths(database); lost > 0) {
      spdlog::warn(
          "{}: the truth of {} clips is left out: its poses are of another skeleton than the new one",
          output.string(), lost);
    }
  }
  if (!options.write_json.empty()) write_markup_file(database, options.write_json);
  if (is_new) save_database(database, output, DatabaseReader(path).note());
  return *database.markup();
}

}  // namespace reprise
