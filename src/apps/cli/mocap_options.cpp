// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "mocap_options.h"

#include <map>
#include <memory>
#include <string>

namespace reprise::cli {
namespace {

struct Switches {
  bool no_deform = false;
  bool no_skips = false;
  bool no_planting = false;
  bool keep_size = false;
};

const std::map<std::string, Timing> timings = {
    {"repeats", Timing::repeats}, {"linear", Timing::linear}, {"smooth", Timing::smooth}};

const std::map<std::string, DriveModel> models = {
    {"part", DriveModel::part}, {"whole", DriveModel::whole}, {"laplacian", DriveModel::laplacian},
    {"lbs", DriveModel::lbs},   {"dqs", DriveModel::dqs},     {"rest-lbs", DriveModel::rest_lbs},
    {"none", DriveModel::none}};

}  // namespace

std::function<void()> add_mocap_options(CLI::App& command, MocapStageOptions& options) {
  const auto given = std::make_shared<Switches>();
  command.add_option("--graph", options.graph,
                     "surface motion graph of the database, from `reprise graph`; default: made with default "
                     "options");
  command.add_option("--map", options.joint_map,
                     "which joints of the motion are those of the body, FILE.json (docs/motion-files.md); "
                     "default: found from the names");

  const char* const retrieval = "Retrieval";
  RetrievalOptions& asked = options.mocap.retrieval;
  command
      .add_option("--threshold", asked.threshold,
                  "frames farther from the query are not shown, metres a joint")
      ->group(retrieval);
  command
      .add_option(
          "--velocity-weight", asked.velocity_weight,
          "frames: count differences of joint velocities (m/frame) times this; 0: joints alone, as in "
          "the paper")
      ->check(CLI::NonNegativeNumber)
      ->group(retrieval);
  command
      .add_option("--most-repeats", asked.most_repeats, "times in a row a frame may be shown again; 0: none")
      ->check(CLI::Range(0, 63))
      ->group(retrieval);
  command.add_flag("--no-skips", given->no_skips, "show every frame of a clip, however fast the query is")
      ->group(retrieval);
  command.add_option("--without", options.without, "clips that are not shown")
      ->delimiter(',')
      ->group(retrieval);
  command.add_option("--alternatives", asked.count, "answers wanted that differ: NAME, NAME-2, ...")
      ->check(CLI::PositiveNumber)
      ->group(retrieval);

  const char* const animation = "Animation";
  command
      .add_option(
          "--timing", options.mocap.timing,
          "repeated frames: repeats (they stand), linear (an even way to the next, as in the paper) or "
          "smooth (without corners)")
      ->transform(CLI::CheckedTransformer(timings))
      ->default_str("smooth")
      ->group(animation);
  command
      .add_option(
          "--model", options.mocap.model,
          "how frames take the query's pose: part or whole (learnt, `reprise model learn`), laplacian, "
          "lbs or dqs (skinning), rest-lbs (skinning of one frame) or none")
      ->transform(CLI::CheckedTransformer(models))
      ->default_str("part")
      ->group(animation);
  command.add_flag("--no-deform", given->no_deform, "retrieval and interpolation alone; --model none")
      ->group(animation);
  command.add_flag("--no-planting", given->no_planting, "feet that stand in the query may slide")
      ->group(animation);
  command.add_flag("--keep-size", given->keep_size, "as far over the ground as the query, whatever the legs")
      ->group(animation);
  command
      .add_option("--drive-vertices", options.drive_vertices,
                  "vertices that drive the surface, FILE.json; default: chosen")
      ->group(animation);
  return [given, &options] {
    if (given->no_deform) options.mocap.model = DriveModel::none;
    options.mocap.retrieval.allow_skips = !given->no_skips;
    options.mocap.retargeting.plant_feet = !given->no_planting;
    options.mocap.retargeting.scale_path = !given->keep_size;
  };
}

}  // namespace reprise::cli
