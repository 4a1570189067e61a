// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Undo and redo over small states.

#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace reprise {

// A line of states and the place in it. `State` is cheap to copy.
template <typename State>
class EditHistory {
 public:
  explicit EditHistory(State first) { states_.push_back(std::move(first)); }

  const State& now() const { return states_[now_idx_]; }
  // Null where the line ends.
  const State* before() const { return now_idx_ > 0 ? &states_[now_idx_ - 1] : nullptr; }
  const State* after() const { return now_idx_ + 1 < states_.size() ? &states_[now_idx_ + 1] : nullptr; }

  void step_back() { --now_idx_; }
  void step_on() { ++now_idx_; }

  // A new step; what was undone before is forgotten.
  void push(State state) {
    states_.reserve(now_idx_ + 2);  // nothing is forgotten if this throws
    states_.resize(now_idx_ + 1, state);
    states_.push_back(std::move(state));
    ++now_idx_;
  }
  // The same step, otherwise: what was undone before is forgotten as well.
  void replace(State state) {
    states_.resize(now_idx_ + 1, state);
    states_.back() = std::move(state);
  }
  // The last step has changed nothing after all.
  void drop_last_step() {
    states_.pop_back();
    --now_idx_;
  }

 private:
  std::vector<State> states_;
  std::size_t now_idx_ = 0;
};

}  // namespace reprise
