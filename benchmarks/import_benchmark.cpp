// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Import of captured OBJ frames into memory: this library's reader against Assimp 5, on the same files in one
// run.
//
//   import_benchmark [FOLDER...]     folders of OBJ frames; without one, the captures in $REPRISE_DATA/ama
//
// Both sides read every file whole and parse it, this library also checks it against the first frame; neither
// keeps a frame. Medians over passes are printed. The peak of resident memory grows through the run: this
// library comes first.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/io/sequence_reader.h"

namespace {

namespace fs = std::filesystem;

double peak_resident_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

template <typename Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Opens every clip and reads all of its frames.
void import_with_reprise(const std::vector<fs::path>& clips, std::atomic<std::size_t>& vertices) {
  for (const fs::path& clip : clips) {
    const std::unique_ptr<reprise::SequenceReader> reader = reprise::open_sequence({.path = clip});
    reprise::parallel_for(0, reader->frame_count(), [&](std::size_t i) {
      vertices += static_cast<std::size_t>(reader->read(i).positions.rows());
    });
  }
}

// An importer a frame, as a thread needs its own. Without steps Assimp hands out one vertex for each face
// corner; joining identical vertices brings back most of the vertices of the file.
void import_with_assimp(const std::vector<fs::path>& files, unsigned steps,
                        std::atomic<std::size_t>& vertices) {
  reprise::parallel_for(0, files.size(), [&](std::size_t i) {
    Assimp::Importer importer;
    const aiScene* const scene = importer.ReadFile(files[i].string(), steps);
    if (scene == nullptr) throw reprise::FileError(files[i], importer.GetErrorString());
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) vertices += scene->mMeshes[m]->mNumVertices;
  });
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<fs::path> clips;
  for (int i = 1; i < argc; ++i) clips.emplace_back(argv[i]);
  if (const char* data = std::getenv("REPRISE_DATA"); clips.empty() && data != nullptr) {
    clips = {fs::path(data) / "ama" / "crane", fs::path(data) / "ama" / "jumping"};
  }
  if (clips.empty()) {
    fmt::print(stderr, "name a folder of OBJ frames, or set REPRISE_DATA\n");
    return 2;
  }

  std::vector<fs::path> files;
  std::size_t bytes = 0;
  for (const fs::path& clip : clips) {
    const std::unique_ptr<reprise::SequenceReader> reader = reprise::open_sequence({.path = clip});
    for (std::size_t i = 0; i < reader->frame_count(); ++i) {
      files.emplace_back(reader->frame_name(i));
      bytes += reader->frame_bytes(i);
    }
  }
  const double megabytes = static_cast<double>(bytes) / 1e6;
  fmt::print("{} frames in {} clips, {:.1f} MB\n", files.size(), clips.size(), megabytes);

  constexpr int passes = 5, assimp_passes = 3;
  std::atomic<std::size_t> vertices = 0;
  std::vector<double> rates;
  const auto report = [&](const char* name, int threads, int count, const auto& import) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    vertices = 0;
    std::vector<double> times;
    for (int pass = 0; pass < count; ++pass) times.push_back(seconds(import));
    const double rate = megabytes / median(times);
    rates.push_back(rate);
    fmt::print("{:24} {} thread{}  {:8.1f} MB/s  {:7.1f} frames/s  {:9.0f} vertices a pass  peak {:.0f} MB\n",
               name, threads, threads == 1 ? " " : "s", rate,
               static_cast<double>(files.size()) / median(times), static_cast<double>(vertices) / count,
               peak_resident_mb());
    std::fflush(stdout);
  };
  const auto reprise_import = [&] { import_with_reprise(clips, vertices); };
  const auto assimp_import = [&] { import_with_assimp(files, 0, vertices); };
  const auto assimp_joined = [&] { import_with_assimp(files, aiProcess_JoinIdenticalVertices, vertices); };
  report("warm-up (page cache)", 2, 1, reprise_import);
  report("reprise", 1, passes, reprise_import);
  report("reprise", 2, passes, reprise_import);
  report("assimp, raw corners", 1, assimp_passes, assimp_import);
  report("assimp, raw corners", 2, assimp_passes, assimp_import);
  report("assimp, joined vertices", 2, 1, assimp_joined);
  fmt::print("reprise / assimp (raw corners): {:.1f} times on 1 thread, {:.1f} times on 2 threads\n",
             rates[1] / rates[3], rates[2] / rates[4]);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "error: {}\n", error.what());
  return 1;
}
