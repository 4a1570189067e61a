// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/markup.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
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

std::size_t count_truths(const PerformanceDatabase& database) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < database.clips().size(); ++c) count += database.truth(c) != nullptr ? 1 : 0;
  return count;
}

}  // namespace

Markup mark_up(const std::filesystem::path& path, const MarkupOptions& options,
               const std::filesystem::path& output) {
  const bool is_new = !options.landmarks.empty() || !options.file.empty();
  if (!options.landmarks.empty() && !options.file.empty()) {
    throw InvalidArgument("landmarks and a markup file are given: expected one of them");
  }
  if (is_new && output.empty()) throw InvalidArgument("a new markup needs a database to be written to");
  if (!is_new && !output.empty()) throw InvalidArgument("expected landmarks or a markup file");
  if (!is_new && options.write_json.empty())
    throw InvalidArgument("nothing to do: neither new markup nor output");
  check_outputs({{output, ".reprise"}, {options.write_json, ".json"}},
                {path, options.landmarks, options.file});

  PerformanceDatabase database = load_database(path);
  if (is_new) {
    const std::size_t truths = count_truths(database);
    database.set_markup(options.landmarks.empty() ? read_markup_file(options.file, database, options.frame)
                                                  : propose(database, options));
    if (const std::size_t lost = truths - count_truths(database); lost > 0) {
      spdlog::warn(
          "{}: the truth of {} clips is left out: its poses are of another skeleton than the new one",
          output.string(), lost);
    }
  }
  if (!options.write_json.empty()) write_markup_file(database, options.write_json);
  if (is_new) {
    DatabaseWriter writer(output, database.topology());
    writer.set_markup(*database.markup());
    for (std::size_t c = 0; c < database.clips().size(); ++c) {
      writer.write_clip(database.clip(c));
      if (const ClipTruth* truth = database.truth(c)) writer.set_truth(*truth);
    }
    writer.set_note(DatabaseReader(path).note());
    writer.commit();
  }
  return *database.markup();
}

}  // namespace reprise
