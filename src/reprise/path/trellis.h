// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The frames a path through the surface motion graph can show, and which can follow which: one column of the
// retrieval trellis (HSSMG 5.2.1, Figure 8).

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reprise/graph/transition.h"

namespace reprise::path_detail {

// Nodes are numbered run by run: the frames of each clip, then the 2 L - 1 blended frames of each transition.
// Within a run the node i - 1 leads to i, and two steps lead from i - 2 to i; that is not stored. What leads
// from one run into another is.
class Trellis {
 public:
  struct Run {
    std::size_t owner_idx = 0;  // of the clip or the transition
    bool blended = false;
    std::size_t first = 0, end = 0;  // nodes first .. end - 1
  };
  // Leads into a node from elsewhere than the two nodes before it in its run.
  struct Entry {
    std::int32_t from = 0;
    std::int32_t via = -1;  // the node that is left out, where it is two steps
    double cost = 0.0;      // of the transition, if a blend is entered on the way
    bool is_skip() const { return via >= 0; }
  };

  // Throws `InvalidArgument` for a transition that does not fit the clips.
  Trellis(std::vector<int> frame_counts, std::vector<Transition> transitions);

  std::size_t node_count() const { return runs_.back().end; }
  std::span<const Run> runs() const { return runs_; }
  const Run& run_of(std::size_t node) const;
  const Run& clip_run(std::size_t clip_idx) const { return runs_[clip_idx]; }
  const Run& blend_run(std::size_t transition_idx) const { return runs_[clip_count_ + transition_idx]; }
  std::size_t clip_count() const { return clip_count_; }
  std::span<const Transition> transitions() const { return transitions_; }
  // Where clips end and blends begin.
  std::size_t captured_count() const { return runs_[clip_count_ - 1].end; }

  // Nodes with entries, ascending.
  std::span<const std::int32_t> entered_nodes() const { return entered_; }
  // Of the n-th of those: single steps before skips, then by node.
  std::span<const Entry> entries(std::size_t n) const {
    return std::span(entries_).subspan(first_entry_[n], first_entry_[n + 1] - first_entry_[n]);
  }

 private:
  void collect_entries();

  std::size_t clip_count_;
  std::vector<Transition> transitions_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> entered_;
  std::vector<std::size_t> first_entry_;
  std::vector<Entry> entries_;
};

}  // namespace reprise::path_detail
