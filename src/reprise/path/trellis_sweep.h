// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The cheapest walk through the retrieval trellis, by dynamic programming over the frames of the query
// (HSSMG Eq. 29).

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "reprise/path/trellis.h"

namespace reprise::path_detail {

enum class SweepRule {
  sum,       // Eq. 26: of c_skel and of what edges cost
  greatest,  // the greatest c_skel on the way; edges cost nothing. Keeps no walk
};

struct SweepOptions {
  SweepRule rule = SweepRule::sum;
  double weight = 1.0;  // w_retr
  double limit = 0.0;   // a node whose c_skel is above it cannot be shown
  int most_repeats = 0;
  bool allow_skips = true;
  double repeat_cost = 0.0;
  double skip_cost = 0.0;
};

// Takes the rows of the trellis one by one. The state of a walk is its node and how often in a row the node
// was shown again; of each node the costs of its last `most_repeats` + 1 arrivals are kept, each grown by
// what standing still has cost since. Of equal walks the one with fewer repeats is kept, then a step before a
// skip before what comes from another run, then the lower node.
class TrellisSweep {
 public:
  static constexpr int greatest_repeats = 63;  // what fits beside the way of arrival in a byte

  // How a node came to be shown.
  enum class Arrival : std::uint8_t { start, step, skip, entry, repeat };
  struct Visit {
    std::size_t node = 0;
    Arrival arrival = Arrival::start;
    const Trellis::Entry* entry = nullptr;  // where it arrived by one
  };

  TrellisSweep(const Trellis& trellis, const SweepOptions& options, std::size_t row_count);

  // `dissimilarities`: c_skel of each node to the next frame of the query. False if no node can be reached.
  bool advance(const float* dissimilarities);
  // Of the best walk through the rows so far.
  double best() const { return best_; }
  // That walk, a node each row.
  std::vector<Visit> walk() const;

 private:
  template <SweepRule rule>
  double sweep_part(const float* dissimilarities, std::size_t first, std::size_t end);
  void arrive(std::size_t first, std::size_t end, double* arrivals, std::uint8_t* codes);
  void begin_runs(std::size_t first, std::size_t end, double* arrivals, std::uint8_t* codes) const;

  const Trellis& trellis_;
  SweepOptions options_;
  std::size_t nodes_;
  std::size_t row_ = 0;
  double best_;
  double skip_cost_;  // infinite where skips are not allowed
  // Entries, without what only the walk needs.
  std::vector<std::int32_t> entry_from_;
  std::vector<double> entry_cost_;
  std::vector<std::size_t> first_entry_;
  // Least cost of each node in the last row and in this one, after two that nothing reaches.
  std::vector<double> last_, next_;
  std::vector<double> arrivals_;  // a ring of rows
  // A byte a node and row: how it was arrived at, and (times 4) the repeats before it is left at least cost.
  std::unique_ptr<std::uint8_t[]> codes_;
  std::unique_ptr<std::uint16_t[]> choices_;  // which entry, one a row and entered node
};

}  // namespace reprise::path_detail
