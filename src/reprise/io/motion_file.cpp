// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/motion_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/io/acclaim.h"
#include "reprise/io/bvh.h"
#include "reprise/io/text_lines.h"

namespace reprise {
namespace {

constexpr double cmu_unit = 0.0254 / 0.45;

struct Unit {
  std::string_view name;
  double metres;
};
constexpr std::array<Unit, 5> known_units = {{{"centimetres", 0.01},
                                              {"metres", 1.0},
                                              {"millimetres", 0.001},
                                              {"inches", 0.0254},
                                              {"CMU's unit", cmu_unit}}};

// Greatest extent of a person's joints along an axis, metres: from a child that crouches to a giant that
// reaches up.
constexpr double smallest_person = 0.8, greatest_person = 2.7, usual_person = 1.65;

bool is_human(double size) {
  return size >= smallest_person && size <= greatest_person;
}

// How tall, or with its arms spread how wide, the figure is most of the time. Props that hang on roots of
// their own are none of it.
double size_of(const SkeletalMotion& motion) {
  std::vector<std::size_t> root(motion.skeleton.joints.size()), joints_of_root(root.size());
  for (std::size_t j = 0; j < root.size(); ++j) {
    const int parent = motion.skeleton.joints[j].parent;
    root[j] = parent < 0 ? j : root[static_cast<std::size_t>(parent)];
    ++joints_of_root[root[j]];
  }
  const auto body =
      static_cast<std::size_t>(std::ranges::max_element(joints_of_root) - joints_of_root.begin());
  constexpr std::size_t samples = 100;
  const std::size_t step = std::max<std::size_t>(1, motion.frames.size() / samples);
  std::vector<double> sizes;
  for (std::size_t f = 0; f < motion.frames.size(); f += step) {
    Eigen::AlignedBox3d box;
    for (std::size_t j = 0; j < root.size(); ++j) {
      if (root[j] == body) box.extend(motion.frames[f].position[j]);
    }
    sizes.push_back(box.sizes().maxCoeff());
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

// The known unit with which a figure of that size, in units, is nearest to a person's; by ratio, as sizes
// compare.
const Unit& likely_unit(double size) {
  return *std::ranges::min_element(known_units, {}, [&](const Unit& unit) {
    return std::abs(std::log(size * unit.metres / usual_person));
  });
}

void scale(SkeletalMotion& motion, double factor) {
  for (Joint& joint : motion.skeleton.joints) joint.rest_position *= factor;
  for (SkeletonPose& pose : motion.frames) {
    for (Eigen::Vector3d& position : pose.position) position *= factor;
  }
}

void check_options(const MotionSource& source) {
  const auto check = [](const std::optional<double>& value, const char* what) {
    if (value && (!(*value > 0.0) || !std::isfinite(*value))) {
      throw InvalidArgument(fmt::format("{} {}; expected a positive, finite number", *value, what));
    }
  };
  check(source.metres_per_unit, "metres per unit");
  check(source.frames_per_second, "frames per second");
}

void check_size(const SkeletalMotion& motion, const MotionSource& source, double metres_per_unit) {
  const double size = size_of(motion);
  if (is_human(size)) return;
  if (!(size > 0.0))
    throw FileError(source.motion, "the figure has no size: all of its joints are in one place");
  const double units = size / metres_per_unit;
  const Unit& unit = likely_unit(units);
  const bool fits = is_human(units * unit.metres);
  const double mended = fits ? unit.metres : usual_person / units;
  throw FileError(
      source.motion,
      fmt::format("the figure is {:.4g} m tall with {:.4g} metres a unit; expected {} to {} m: {:.4g} "
                  "metres a unit{} would make it {:.3g} m",
                  size, metres_per_unit, smallest_person, greatest_person, mended,
                  fits ? fmt::format(" ({})", unit.name) : "", units * mended));
}

MotionFile read_bvh_motion(const MotionSource& source) {
  if (!source.skeleton.empty()) {
    throw FileError(source.motion, fmt::format("has a skeleton of its own; '{}' does not go with it",
                                               source.skeleton.string()));
  }
  MotionFile file;
  BvhReadOptions options;
  options.metres_per_unit = source.metres_per_unit.value_or(1.0);
  if (source.frames_per_second) options.frames_per_second = *source.frames_per_second;
  file.motion = read_bvh(source.motion, options);
  file.metres_per_unit = options.metres_per_unit;
  if (!source.metres_per_unit) {
    const double units = size_of(file.motion);
    const Unit& unit = likely_unit(units > 0.0 ? units : 1.0);
    // Where no unit fits the error below speaks of centimetres, the commonest one.
    file.metres_per_unit = is_human(units * unit.metres) ? unit.metres : known_units[0].metres;
    scale(file.motion, file.metres_per_unit);
    file.notes.push_back(fmt::format(
        "the file has no unit: with {} ({:.4g} metres a unit) the figure is {:.2f} m tall, as people are",
        unit.name, file.metres_per_unit, units * file.metres_per_unit));
  }
  return file;
}

// The .asf that goes with an .amc, or an error that names what was looked for.
std::filesystem::path find_skeleton(const std::filesystem::path& motion) {
  namespace fs = std::filesystem;
  const fs::path folder = motion.parent_path().empty() ? fs::path(".") : motion.parent_path();
  const std::string stem = motion.stem().string();
  std::vector<std::string> names = {stem};
  if (const std::size_t cut = stem.find('_'); cut != std::string::npos && cut > 0) {
    names.insert(names.begin(), stem.substr(0, cut));
  }
  std::vector<std::string> tried;
  for (const fs::path& place : {folder, folder / ".." / "asf"}) {
    for (const std::string& name : names) {
      const fs::path candidate = (place / (name + ".asf")).lexically_normal();
      tried.push_back(candidate.string());
      std::error_code error;
      if (fs::is_regular_file(candidate, error)) return candidate;
    }
  }
  std::vector<fs::path> beside;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (same_word(entry.path().extension().string(), ".asf")) beside.push_back(entry.path());
  }
  if (beside.size() == 1) return beside.front();
  throw FileError(
      motion,
      fmt::format("needs its skeleton, an .asf file: there is none of {}, and {} .asf {} beside "
                  "it; name it",
                  fmt::join(tried, ", "), beside.size(), beside.size() == 1 ? "file lies" : "files lie"));
}

MotionFile read_acclaim_motion(const MotionSource& source) {
  MotionFile file;
  AcclaimReadOptions options;
  if (source.metres_per_unit) options.metres_per_unit = *source.metres_per_unit;
  if (source.frames_per_second) options.frames_per_second = *source.frames_per_second;
  std::filesystem::path skeleton = source.skeleton;
  if (skeleton.empty()) {
    std::error_code error;
    if (!std::filesystem::exists(source.motion, error)) throw FileError(source.motion, "does not exist");
    skeleton = find_skeleton(source.motion);
    file.notes.push_back(fmt::format("its skeleton is taken to be '{}'", skeleton.string()));
  }
  if (!same_word(skeleton.extension().string(), ".asf")) {
    throw FileError(skeleton,
                    fmt::format("is no skeleton of '{}': expected an .asf file", source.motion.string()));
  }
  file.motion = read_acclaim(skeleton, source.motion, options);
  file.metres_per_unit = options.metres_per_unit;
  if (!source.frames_per_second) {
    file.notes.push_back(
        fmt::format("the file has no rate: taken as {} frames a second, CMU's", options.frames_per_second));
  }
  if (!source.metres_per_unit) file.notes.push_back("lengths are taken to be in CMU's unit, 0.0254 / 0.45 m");
  return file;
}

}  // namespace

MotionFile read_motion(const MotionSource& source) {
  check_options(source);
  const std::string extension = source.motion.extension().string();
  MotionFile file;
  if (same_word(extension, ".bvh")) {
    file = read_bvh_motion(source);
  } else if (same_word(extension, ".amc")) {
    file = read_acclaim_motion(source);
  } else {
    throw FileError(source.motion,
                    fmt::format("is no motion this program reads: expected a .bvh or .amc file, found {}",
                                extension.empty() ? "no extension" : in_quotes(extension)));
  }
  check_size(file.motion, source, file.metres_per_unit);
  constexpr double slowest = 4.0, fastest = 2000.0;
  const double rate = file.motion.frames_per_second;
  if (!(rate >= slowest && rate <= fastest)) {
    throw FileError(source.motion, fmt::format("has {:.4g} frames a second; expected {} to {}: give the rate",
                                               rate, slowest, fastest));
  }
  return file;
}

}  // namespace reprise
