// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/skeleton.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.h"
#include "reprise/core/atomic_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {

Action add_skeleton(CLI::App& command) {
  using Position = SkeletonExtractionOptions::JointPosition;
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path folder;
    std::filesystem::path report;
    SkeletonOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  SkeletonExtractionOptions& extraction = arguments->options.extraction;
  command.add_option("database", arguments->database, "a .reprise file with markup")->required();
  command.add_option("--clip", arguments->options.clip, "the clip to look at; all if none is named");
  command.add_option("-o,--output", arguments->folder, "folder for CLIP.bvh, one file a clip");
  command.add_option("--report", arguments->report, "write what was found, FILE.json");
  command
      .add_option("--position", extraction.position,
                  "joints: rigid (where the bones on both sides carry them) or centroid (of the joint's "
                  "labelled vertices, as in the paper)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Position>{{"rigid", Position::rigid}, {"centroid", Position::centroid}}))
      ->default_str("rigid");
  command
      .add_option("--fewest-vertices", extraction.fewest_vertices,
                  "bones with fewer labelled vertices are placed between their neighbours")
      ->check(CLI::Range(3, 1000000));
  return [arguments] {
    check_outputs({{arguments->report, ".json"}}, {arguments->database});
    const SkeletonResult result = extract_skeletons(arguments->database, arguments->options);
    if (!arguments->folder.empty()) write_skeletons(result.motions, arguments->folder);
    if (!arguments->report.empty()) {
      write_text_file(arguments->report,
                      result.report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    }
    std::vector<std::string> inferred;
    for (const nlohmann::json& joint : result.report["joints"]) {
      if (!joint["followed"].get<bool>()) inferred.push_back(joint["name"].get<std::string>());
    }
    fmt::print("{}: {} joints{}\n", arguments->database.string(), result.report["joints"].size(),
               inferred.empty()
                   ? std::string()
                   : fmt::format(", placed between their neighbours: {}", fmt::join(inferred, ", ")));
    for (const nlohmann::json& clip : result.report["clips"]) {
      fmt::print("  {:<20} {:>6} frames  bone lengths within {:.1f} % on average",
                 clip["name"].get<std::string>(), clip["frames"].get<std::size_t>(),
                 100.0 * clip["length_error"]["mean"].get<double>());
      if (const nlohmann::json& difference = clip["difference"]; !difference.is_null()) {
        fmt::print(", {:.2f} cm and {:.2f} degrees from the truth",
                   100.0 * difference["distance"].get<double>(), difference["angle_degrees"].get<double>());
      }
      fmt::print("\n");
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
