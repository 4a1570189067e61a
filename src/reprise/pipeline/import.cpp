// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/import.h"

#include <charconv>
#include <chrono>
#include <optional>

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_file.h"

namespace reprise {
namespace {

constexpr double default_frames_per_second = 25.0;

double parse_positive(const std::string& text, const std::string& option) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0.0)) {
    throw InvalidArgument(fmt::format("{}: '{}' is not a positive number", option, text));
  }
  return value;
}

// Reads frames on all cores and hands them to `writer` in order, with no more frames in flight than keep the
// cores busy.
void stream_frames(const SequenceReader& reader, DatabaseWriter& writer, Progress& progress) {
  const auto in_flight = static_cast<std::size_t>(2 * tbb::this_task_arena::max_concurrency());
  std::size_t next = 0;
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
        if (next == reader.frame_count()) control.stop();
        return next++;
      }) & tbb::make_filter<std::size_t, Mesh>(tbb::filter_mode::parallel, [&](std::size_t frame_idx) {
        return reader.read(frame_idx);
      }) & tbb::make_filter<Mesh, void>(tbb::filter_mode::serial_in_order, [&](const Mesh& mesh) {
        writer.append(mesh);
        progress.advance();
      }));
}

void copy_contents(const DatabaseReader& reader, DatabaseWriter& writer) {
  if (reader.markup()) writer.set_markup(*reader.markup());
  writer.set_models(reader.read_models());
  for (std::size_t c = 0; c < reader.clips().size(); ++c) {
    const MeshSequence clip = reader.read_clip(c);
    writer.write_clip(clip);
    if (const std::optional<ClipTruth> truth = reader.read_truth(c)) writer.set_truth(*truth);
  }
}

}  // namespace

ImportSequence parse_import_sequence(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InvalidArgument(
        fmt::format("'{}' is not a sequence: expected NAME=PATH[,fps=25][,topology=FILE]", text));
  }
  ImportSequence sequence{.name = text.substr(0, equals)};
  std::size_t begin = equals + 1;
  for (bool first = true; begin <= text.size(); first = false) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    begin = end + 1;
    if (first) {
      sequence.source.path = item;
      continue;
    }
    const std::size_t sign = item.find('=');
    const std::string key = item.substr(0, sign);
    const std::string value = sign == std::string::npos ? std::string() : item.substr(sign + 1);
    if (key == "fps") {
      sequence.frames_per_second = parse_positive(value, "fps");
    } else if (key == "topology") {
      sequence.source.topology = value;
    } else if (key == "scale") {
      sequence.source.scale = parse_positive(value, "scale");
    } else if (key == "id") {
      sequence.source.sequence_id = value;
    } else {
      throw InvalidArgument(fmt::format(
          "sequence '{}': unknown setting '{}'; expected fps, topology, scale or id", sequence.name, key));
    }
  }
  if (sequence.source.path.empty()) {
    throw InvalidArgument(fmt::format("sequence '{}': no path after '='", sequence.name));
  }
  return sequence;
}

ImportReport import_sequences(const std::filesystem::path& database, const ImportOptions& options) {
  if (options.sequences.empty()) throw InvalidArgument("nothing to import: no sequence was given");
  const auto start = std::chrono::steady_clock::now();

  // Open everything first: a wrong path fails before anything long is done.
  std::vector<std::unique_ptr<SequenceReader>> readers;
  ImportReport report{.clips = options.sequences.size()};
  for (const ImportSequence& sequence : options.sequences) {
    readers.push_back(open_sequence(sequence.source));
    report.frames += readers.back()->frame_count();
  }
  std::unique_ptr<DatabaseReader> existing;
  if (options.append && std::filesystem::exists(database))
    existing = std::make_unique<DatabaseReader>(database);

  const TopologyPtr topology = existing ? existing->topology() : readers.front()->topology();
  const std::string topology_owner = existing ? database.string() : readers.front()->frame_name(0);
  for (std::size_t s = 0; s < readers.size(); ++s) {
    const std::string difference =
        first_difference(*topology, *readers[s]->topology(), topology_owner, readers[s]->frame_name(0));
    if (!difference.empty()) {
      throw FileError(options.sequences[s].source.path,
                      "all clips of a database share one topology, but " + difference);
    }
  }

  std::vector<double> rates;
  for (std::size_t s = 0; s < readers.size(); ++s) {
    rates.push_back(options.sequences[s].frames_per_second > 0.0
                        ? options.sequences[s].frames_per_second
                        : readers[s]->frames_per_second().value_or(default_frames_per_second));
    const double expected = existing ? existing->clips().front().frames_per_second : rates.front();
    if (rates[s] != expected) {
      throw InvalidArgument(fmt::format(
          "sequence '{}' has {} frames per second and the database {}: expected one rate (set it with fps=)",
          options.sequences[s].name, rates[s], expected));
    }
  }

  DatabaseWriter writer(database, topology);
  if (existing) copy_contents(*existing, writer);
  Progress progress("import", report.frames);
  for (std::size_t s = 0; s < readers.size(); ++s) {
    const ImportSequence& sequence = options.sequences[s];
    writer.begin_clip(sequence.name, rates[s]);
    stream_frames(*readers[s], writer, progress);
    for (std::size_t f = 0; f < readers[s]->frame_count(); ++f) report.bytes += readers[s]->frame_bytes(f);
  }
  existing.reset();  // closes the file that is about to be replaced
  writer.commit();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace reprise
