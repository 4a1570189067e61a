// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/open.h"
#include "reprise/synthesis/naturalness.h"

namespace reprise::cli {

Action add_evaluate_naturalness(CLI::App& command) {
  struct Arguments {
    std::filesystem::path result;
    std::filesystem::path database;
    std::string clip;
    bool json = false;
    ContactOptions contacts;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("result", arguments->result, "a generated .reprise file")->required();
  command.add_option("--database", arguments->database, "the database it was generated from")->required();
  command.add_option("--clip", arguments->clip, "which clip, if the file has several");
  command.add_option("--contact-height", arguments->contacts.height, "metres above the ground");
  command.add_option("--contact-speed", arguments->contacts.speed, "m/s");
  command.add_flag("--json", arguments->json, "print JSON for machines");
  return [arguments] {
    const PerformanceDatabase database = load_database(arguments->database);
    const MeshSequence clip = open_clip(arguments->result, arguments->clip);
    const Naturalness n = evaluate_naturalness(clip, database, arguments->contacts);
    if (arguments->json) {
      fmt::print("{}\n", nlohmann::json{{"pop_ratio", n.pop_ratio},
                                        {"captured_pop_ratio", n.captured_pop_ratio},
                                        {"peak_acceleration_m_frame2", n.peak_acceleration},
                                        {"captured_acceleration_p99_m_frame2", n.captured_acceleration_p99},
                                        {"foot_drift_cm_s", n.foot_drift},
                                        {"blend_foot_drift_cm_s", n.blend_foot_drift},
                                        {"captured_foot_drift_cm_s", n.captured_foot_drift},
                                        {"shown_foot_drift_cm_s", n.shown_foot_drift},
                                        {"edge_stretch_p99", n.edge_stretch_p99},
                                        {"captured_edge_stretch_p99", n.captured_edge_stretch_p99}}
                             .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
      return exit_success;
    }
    fmt::print("{:<28} {:>10} {:>10}\n", "", "animation", "captured");
    fmt::print("{:<28} {:>10.3f} {:>10.3f}\n", "pop ratio", n.pop_ratio, n.captured_pop_ratio);
    fmt::print("{:<28} {:>10.3f} {:>10.3f}\n", "foot drift, cm/s", n.foot_drift, n.captured_foot_drift);
    fmt::print("{:<28} {:>10} {:>10.3f}\n", "  in the frames shown, cm/s", "", n.shown_foot_drift);
    fmt::print("{:<28} {:>10.3f}\n", "  inside blends, cm/s", n.blend_foot_drift);
    fmt::print("{:<28} {:>10.3f} {:>10.3f}\n", "edge stretch, 99 %", n.edge_stretch_p99,
               n.captured_edge_stretch_p99);
    return exit_success;
  };
}

}  // namespace reprise::cli
