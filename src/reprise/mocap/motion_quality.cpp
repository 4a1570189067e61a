// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/motion_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reprise/core/error.h"
#include "reprise/graph/captured_acceleration.h"

namespace reprise {
namespace {

constexpr std::array sides = {"left_foot", "right_foot"};
constexpr float sole_thickness = 0.03F;  // metres above its lowest point that are down

std::array<std::vector<std::int32_t>, 2> find_soles(const Markup& markup, const JointMap& map,
                                                    const GroundContacts& contacts) {
  std::array<Eigen::Vector3d, 2> joints;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto joint = map.joints.find(sides[side]);
    if (joint == map.joints.end()) return {};
    joints[side] = markup.skeleton.joints[static_cast<std::size_t>(markup.skeleton.joint_idx(joint->second))]
                       .rest_position;
  }
  std::array<std::vector<std::int32_t>, 2> soles;
  for (const std::vector<std::int32_t>& patch : contacts.feet()) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const std::int32_t v : patch) middle += markup.reference.row(v).transpose().cast<double>();
    middle /= static_cast<double>(patch.size());
    const std::size_t side = (middle - joints[0]).norm() <= (middle - joints[1]).norm() ? 0 : 1;
    soles[side].insert(soles[side].end(), patch.begin(), patch.end());
  }
  for (std::vector<std::int32_t>& sole : soles) std::ranges::sort(sole);
  return soles;
}

float lowest_point(const std::vector<std::int32_t>& sole, const Positions& frame) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const std::int32_t v : sole) lowest = std::min(lowest, frame(v, 1));
  return lowest;
}

}  // namespace

MotionQualityScale::MotionQualityScale(const PerformanceDatabase& database, const JointMap& map,
                                       const ContactOptions& options) {
  if (!database.markup()) {
    throw InvalidArgument(
        "the database has no markup, which says where the feet are: give it one with "
        "`reprise markup`");
  }
  const GroundContacts contacts(database, options);
  edges_ = std::make_shared<const ReferenceEdges>(*database.topology(), database.clip(0).frame(0));
  captured_ = captured_naturalness(database, contacts, edges_);
  soles_ = find_soles(*database.markup(), map, contacts);
}

MotionQualityMeter::MotionQualityMeter(const MotionQualityScale& scale, double frames_per_second)
    : scale_(scale), frames_per_second_(frames_per_second), stretch_(scale.edges_) {}

void MotionQualityMeter::add(const Positions& frame, bool is_blend, const FootContacts& contacts) {
  stretch_.add(PositionsView(frame.data(), frame.rows(), 3));
  if (seen_.size() == 3) std::rotate(seen_.begin(), seen_.begin() + 1, seen_.end());
  if (seen_.size() < 3) seen_.emplace_back();
  seen_.back() = {.positions = frame, .is_blend = is_blend, .contacts = contacts};
  if (seen_.size() > 1) add_feet(*(seen_.end() - 2), seen_.back());
  if (seen_.size() < 3) return;
  const auto view = [this](std::size_t i) {
    return PositionsView(seen_[i].positions.data(), seen_[i].positions.rows(), 3);
  };
  const double acceleration = peak_acceleration(view(0), view(1), view(2));
  peak_ = std::max(peak_, acceleration);
  if (std::ranges::any_of(seen_, &Seen::is_blend)) blend_peak_ = std::max(blend_peak_, acceleration);
}

void MotionQualityMeter::add_feet(const Seen& now, const Seen& next) {
  for (std::size_t side = 0; side < 2; ++side) {
    const std::vector<std::int32_t>& sole = scale_.soles_[side];
    if (!now.contacts[side] || !next.contacts[side] || sole.empty()) continue;
    const float low_now = lowest_point(sole, now.positions);
    const float low_next = lowest_point(sole, next.positions);
    height_sum_ += std::abs(static_cast<double>(low_now));
    ++height_count_;
    for (const std::int32_t v : sole) {
      if (now.positions(v, 1) > low_now + sole_thickness || next.positions(v, 1) > low_next + sole_thickness)
        continue;
      speed_sum_ += std::hypot(static_cast<double>(next.positions(v, 0) - now.positions(v, 0)),
                               static_cast<double>(next.positions(v, 2) - now.positions(v, 2)));
      ++speed_count_;
    }
  }
}

MotionQuality MotionQualityMeter::quality() const {
  constexpr double centimetres = 100.0;
  MotionQuality quality{.edge_stretch_p99 = stretch_.percentile(0.99)};
  if (const double usual = scale_.captured_.acceleration_p99; usual > 0.0) {
    quality.pop_ratio = blend_peak_ / usual;
    quality.peak_ratio = peak_ / usual;
  }
  if (speed_count_ > 0) {
    quality.foot_drift = centimetres * frames_per_second_ * speed_sum_ / static_cast<double>(speed_count_);
  }
  if (height_count_ > 0) quality.foot_height = centimetres * height_sum_ / static_cast<double>(height_count_);
  return quality;
}

}  // namespace reprise
