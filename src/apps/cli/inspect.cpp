// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/inspect.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "command.h"

namespace reprise::cli {

Action add_info(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command.add_flag("--json", arguments->json, "print JSON for machines");
  return [arguments] {
    const nlohmann::json info = describe_database(arguments->database);
    if (arguments->json) {
      fmt::print("{}\n", info.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
      return exit_success;
    }
    fmt::print("{}: {} vertices, {} triangles{}, {} frames\n", info["path"].get<std::string>(),
               info["vertices"].get<int>(), info["triangles"].get<int>(),
               info["texture_coordinates"].get<bool>() ? ", texture coordinates" : "",
               info["frames"].get<int>());
    if (const nlohmann::json& texture = info["texture"]; !texture.is_null()) {
      fmt::print("  texture  {} x {} pixels\n", texture["width"].get<int>(), texture["height"].get<int>());
    }
    if (const nlohmann::json& markup = info["markup"]; !markup.is_null()) {
      for (const char* kind : {"joints", "parts", "layers"}) {
        const nlohmann::json& items = markup[kind];
        if (items.empty()) continue;
        std::vector<std::string> texts;
        for (const nlohmann::json& item : items) {
          texts.push_back(
              fmt::format("{} ({})", item["name"].get<std::string>(), item["vertices"].get<int>()));
        }
        fmt::print("  {} {}: {}\n", items.size(), kind, fmt::join(texts, ", "));
      }
    }
    for (const char* model : {"part", "whole"}) {
      const nlohmann::json& learnt = info["models"][model];
      if (learnt.is_null()) continue;
      std::vector<std::string> texts;
      for (const nlohmann::json& part : learnt["parts"]) {
        texts.push_back(fmt::format("{} ({} components, {} examples)", part["name"].get<std::string>(),
                                    part["components"].get<int>(), part["examples"].get<int>()));
      }
      fmt::print("  {} model: {}\n", model, fmt::join(texts, ", "));
    }
    for (const nlohmann::json& clip : info["clips"]) {
      fmt::print(
          "  {:<20} {:>6} frames  {:>7.2f} s at {:g} fps{}{}{}{}\n", clip["name"].get<std::string>(),
          clip["frames"].get<int>(), clip["seconds"].get<double>(), clip["frames_per_second"].get<double>(),
          clip["colors"].get<bool>() ? "  colours" : "", clip["normals"].get<bool>() ? "  normals" : "",
          clip["provenance"].get<bool>() ? "  generated" : "", clip["truth"].get<bool>() ? "  truth" : "");
    }
    return exit_success;
  };
}

Action add_validate(CLI::App& command) {
  struct Arguments {
    std::filesystem::path path;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("path", arguments->path, "a .reprise file, or a folder of numbered OBJ or PLY files")
      ->required();
  command.add_flag("--json", arguments->json, "print JSON for machines");
  return [arguments] {
    const ValidationReport report = validate_path(arguments->path);
    const auto severity = [](const Finding& finding) {
      return finding.severity == Finding::Severity::error ? "error" : "warning";
    };
    if (arguments->json) {
      nlohmann::json findings = nlohmann::json::array();
      for (const Finding& finding : report.findings) {
        findings.push_back(
            {{"severity", severity(finding)}, {"where", finding.where}, {"what", finding.what}});
      }
      fmt::print("{}\n", nlohmann::json{{"path", arguments->path.string()},
                                        {"frames", report.frames},
                                        {"ok", report.ok()},
                                        {"findings", std::move(findings)}}
                             .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
      for (const Finding& finding : report.findings) {
        fmt::print("{}: {}: {}\n", severity(finding), finding.where, finding.what);
      }
      fmt::print("{}: {} frames, {}\n", arguments->path.string(), report.frames,
                 report.ok() ? "usable" : "not usable as it is");
    }
    return report.ok() ? exit_success : exit_failure;
  };
}

}  // namespace reprise::cli
