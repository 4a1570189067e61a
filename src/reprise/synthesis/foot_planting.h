// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Feet that stand stay where they stand: through blends, retiming and a stretched ground trajectory.

#pragma once

#include "reprise/synthesis/foot_shifts.h"
#include "reprise/synthesis/frame_sources.h"
#include "reprise/synthesis/ground_contacts.h"

namespace reprise {

// What planting did: largest and mean shift of a foot, metres, over frames in which it stands.
struct PlantingReport {
  double largest_shift = 0.0;
  double mean_shift = 0.0;
};

// Moves feet of generated motion and what hangs on them. Made once a database, to which it keeps a reference;
// thread-safe.
class FootPlanter {
 public:
  explicit FootPlanter(const PerformanceDatabase& database, const ContactOptions& options = {});

  // While a foot is in contact in the captured frames that a frame of `sequence` is made of (its origins), it
  // moves over the ground as it did there and no further; in the air its shift goes smoothly from one stand
  // to the next. In a blend it stands if it does in the heavier frame: held fast if it stands in both, else
  // only as far as the leg reaches and the way to the next stand allows.
  //
  // A foot is moved as one piece (it turns about the vertical, too), the leg follows by `leg_weights`, and
  // no leg is drawn out further than the capture ever shows it; nor does a shift accelerate
  // a foot beyond what the capture does. First and last frame stay. A foot that
  // already does what it should is not touched, nor is anything above the hips. Normals, if there are any,
  // are recomputed where the surface moved. Parallel, the same bits for any number of threads. Throws
  // `InvalidArgument` as `frame_sources` does.
  PlantingReport plant(MeshSequence& sequence) const;

  const GroundContacts& contacts() const { return contacts_; }

 private:
  struct Foot {
    std::vector<std::int32_t> sole;       // vertices that are ever in contact
    std::vector<std::int32_t> followers;  // vertices that go along, the sole among them
    std::vector<double> weights;          // of the followers
    std::vector<std::int32_t> hip;        // vertices that stay, next to followers: the upper end of the leg
    double contact_count = 0.0;  // vertices in contact in a frame in which the foot stands, on average
    double radius = 0.0;         // metres: root mean square distance of the sole from its centre
    double longest_leg = 0.0;    // metres from hip to sole over all captured frames; infinite without a hip
  };

  Foot make_foot(const std::vector<std::int32_t>& sole, const Eigen::VectorXd& weights) const;
  FootDemand demand(const Foot& foot, const MeshSequence& sequence, std::size_t frame_idx,
                    const FrameSources& sources) const;
  // `shifts`: of each foot one a frame, or none if it stays. False if the frame stays as it is.
  bool move_feet(PositionsRef frame, std::size_t frame_idx,
                 const std::vector<std::vector<FootShift>>& shifts) const;

  const PerformanceDatabase* database_;
  GroundContacts contacts_;
  double largest_acceleration_ = 0.0;  // of a foot that is shifted, metres/frame^2
  std::vector<Foot> feet_;
};

}  // namespace reprise
