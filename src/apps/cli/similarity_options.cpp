// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "similarity_options.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace reprise::cli {

void add_histogram_options(CLI::App& command, HistogramOptions& options) {
  command
      .add_option_function<std::vector<int>>(
          "--bins",
          [&options](const std::vector<int>& bins) {
            options.radius_bins = bins[0];
            options.polar_bins = bins[1];
            options.azimuth_bins = bins[2];
            for (std::size_t c = 0; c < 3; ++c) options.color_bins[c] = bins[3 + c];
          },
          "shape-colour, shape: bins of radius, polar angle, azimuth, red, green, blue")
      ->delimiter(',')
      ->expected(6)
      ->type_name("R,THETA,PHI,R,G,B")
      ->default_str(fmt::format("{},{},{},{}", options.radius_bins, options.polar_bins, options.azimuth_bins,
                                fmt::join(options.color_bins, ",")));
  command.add_option("--refinement", options.azimuth_refinement,
                     "shape-colour, shape: turns compared in each bin of azimuth");
  command.add_option("--voxel", options.voxel_size, "shape-colour, shape: edge of a voxel, metres");
  command.add_option("--meters-per-color", options.meters_per_color,
                     "shape-colour: how far apart black and full red count, metres");
  command.add_option("--color-footprint", options.color_footprint,
                     "shape-colour: radius over which colours are averaged on the surface, metres");
  command.add_option("--min-color-share", options.min_color_share,
                     "shape-colour: rarer colours count as the nearest frequent one");
}

void add_metric_options(CLI::App& command, SimilarityOptions& options) {
  command.add_option("--metric", options.metric,
                     fmt::format("how frames are compared: {}", fmt::join(similarity_metrics(), ", ")));
  command.add_flag("--exact", options.exact, "every entry exact, not only those that transitions depend on");
  add_histogram_options(command, options.histogram);
}

void add_transition_options(CLI::App& command, TransitionOptions& options) {
  command.add_option("--transitions-per-pair", options.transitions_per_pair,
                     "best transitions kept per ordered pair of clips");
  command.add_option("--max-half-window", options.max_half_window,
                     "longest blend, frames on either side of its centre");
  command.add_option("--min-half-window", options.min_half_window, "shortest blend");
  command.add_option("--self-min-gap", options.self_min_gap,
                     "a clip links to itself only over this many frames");
  command.add_option("--separation", options.separation, "frames between transitions of one pair");
  command
      .add_option_function<std::string>(
          "--criterion",
          [&options](const std::string& name) {
            options.criterion =
                name == "paper-sum" ? WindowCriterion::paper_sum : WindowCriterion::blend_speed;
          },
          "how the length of a blend is chosen: blend-speed, or paper-sum (Eq. 5 literally)")
      ->check(CLI::IsMember({"blend-speed", "paper-sum"}))
      ->default_str("blend-speed");
  command.add_option("--acceleration-weight", options.acceleration_weight,
                     "blend-speed: weight of the peak acceleration, frames^2");
  command.add_option("--max-pop-ratio", options.max_pop_ratio,
                     "no blends that accelerate the surface more than this many times as much as the capture "
                     "does; inf: no limit");
  command
      .add_option_function<std::string>(
          "--profile",
          [&options](const std::string& name) {
            options.profile = name == "linear" ? BlendProfile::linear : BlendProfile::smooth;
          },
          "blend weight along the window: smooth, or linear (Eq. 2)")
      ->check(CLI::IsMember({"smooth", "linear"}))
      ->default_str("smooth");
}

}  // namespace reprise::cli
