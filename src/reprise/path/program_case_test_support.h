// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a program in LP format says when GLPK (GPL, tests only) has solved it, read back by its names alone.

#pragma once

#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <glpk.h>
#include <gtest/gtest.h>

#include "reprise/path/keyframe_case_test_support.h"
#include "support/test_data.h"

namespace reprise::test {

struct ProgramSolution {
  double cost = 0.0;
  std::map<std::string, double> columns;  // by name
  int integer_count = 0;
};

// Nothing if the program has no solution. A text that GLPK cannot read, or a program that it cannot solve
// within `seconds`, is a failure of the test.
inline std::optional<ProgramSolution> solve_lp_text(const std::string& text, int seconds = 60) {
  const TemporaryFolder folder;
  const std::string path = (folder / "program.lp").string();
  std::ofstream(path) << text;
  glp_term_out(GLP_OFF);
  glp_prob* problem = glp_create_prob();
  std::optional<ProgramSolution> solution;
  if (glp_read_lp(problem, nullptr, path.c_str()) != 0) {
    ADD_FAILURE() << "not in LP format:\n" << text;
    glp_delete_prob(problem);
    return solution;
  }
  // Without the presolver of integer programs, which takes a row missed by 0.001 for kept.
  glp_smcp relaxed;
  glp_init_smcp(&relaxed);
  glp_iocp control;
  glp_init_iocp(&control);
  control.tm_lim = 1000 * seconds;
  int failed = glp_simplex(problem, &relaxed);
  int status = glp_get_status(problem);
  if (failed == 0 && status == GLP_OPT) {
    failed = glp_intopt(problem, &control);
    status = glp_mip_status(problem);
  }
  if (failed == 0 && status == GLP_OPT) {
    solution.emplace();
    solution->cost = glp_mip_obj_val(problem);
    solution->integer_count = glp_get_num_int(problem);
    for (int i = 1; i <= glp_get_num_cols(problem); ++i) {
      solution->columns[glp_get_col_name(problem, i)] = glp_mip_col_val(problem, i);
    }
  } else if (failed != 0 || status != GLP_NOFEAS) {
    ADD_FAILURE() << "GLPK gave up: " << failed << ", status " << status;
  }
  glp_delete_prob(problem);
  return solution;
}

// The path a solution describes, by the head comment's rule: each leg from its key-frame along the columns,
// each as often as it says. Fails the test unless that uses up every column, which a loose loop would not.
// Precondition: the clips are named clip0, clip1, ...
class DecodedPath {
 public:
  DecodedPath(const Case& query_case, const ProgramSolution& solution) : case_(query_case) {
    const std::vector<FrameId>& keyframes = query_case.query.keyframes;
    legs_.resize(keyframes.size() - 1);
    for (const auto& [name, value] : solution.columns) add_column(name, value);
    path_.segments.push_back({.clip_idx = keyframes.front().clip_idx,
                              .first_frame = static_cast<int>(keyframes.front().frame_idx),
                              .transition = {}});
    for (std::size_t i = 0; i < legs_.size(); ++i) follow_leg(i);
    path_.segments.back().last_frame = static_cast<int>(keyframes.back().frame_idx);
    for (const PathSegment& segment : path_.segments) {
      if (segment.transition) path_.costs.transitions += segment.transition->cost;
    }
    path_.cost = path_.lower_bound = solution.cost;
    path_.distance = solution.columns.at("distance");
    path_.frame_count = static_cast<int>(std::lround(solution.columns.at("frames")));
    path_.time = path_.frame_count / fps;
  }

  const MotionPath& path() const { return path_; }

 private:
  using State = std::pair<std::string, int>;  // clip, frame
  struct Move {
    State target;
    int transition = -1;
    int uses = 0;
  };
  using Leg = std::map<State, std::vector<Move>>;

  void add_column(const std::string& name, double value) {
    std::vector<std::string> words;
    std::istringstream text(name);
    for (std::string word; std::getline(text, word, '.');) words.push_back(word);
    if (words[0] != "play" && words[0] != "take") return;
    const int uses = static_cast<int>(std::lround(value));
    EXPECT_NEAR(value, uses, 1e-4) << name;
    Leg& leg = legs_[static_cast<std::size_t>(std::stoi(words[1])) - 1];
    if (words[0] == "play") {
      leg[{words[2], std::stoi(words[3])}].push_back({{words[2], std::stoi(words[4])}, -1, uses});
    } else {
      leg[{words[3], std::stoi(words[4])}].push_back(
          {{words[5], std::stoi(words[6])}, std::stoi(words[2].substr(1)), uses});
    }
  }

  static State state_of(const FrameId& frame) {
    return {"clip" + std::to_string(frame.clip_idx), static_cast<int>(frame.frame_idx)};
  }

  // Hierholzer's walk: at a dead end step back, and what was stepped back over comes last.
  void follow_leg(std::size_t leg_idx) {
    Leg& leg = legs_[leg_idx];
    std::vector<std::pair<State, int>> open{{state_of(case_.query.keyframes[leg_idx]), -1}};
    std::vector<std::pair<State, int>> walk;  // backwards: where each move ends, and its transition
    while (!open.empty()) {
      Move* next = nullptr;
      for (Move& move : leg[open.back().first]) {
        if (move.uses > 0) next = &move;
      }
      if (next == nullptr) {
        walk.push_back(open.back());
        open.pop_back();
      } else {
        --next->uses;
        open.emplace_back(next->target, next->transition);
      }
    }
    EXPECT_GT(walk.size(), 1u) << "leg " << leg_idx + 1 << " has no move";
    EXPECT_EQ(walk.front().first, state_of(case_.query.keyframes[leg_idx + 1]));
    for (const auto& [state, moves] : leg) {
      for (const Move& move : moves) {
        EXPECT_EQ(move.uses, 0) << "a loose loop through " << state.first << ":" << state.second;
      }
    }
    for (std::size_t i = walk.size() - 1; i-- > 0;) {
      if (walk[i].second < 0) continue;
      const Transition& transition = case_.transitions[static_cast<std::size_t>(walk[i].second)];
      EXPECT_EQ(walk[i + 1].first,
                (State{"clip" + std::to_string(transition.source_clip), transition.leave()}));
      path_.segments.back().last_frame = transition.leave();
      path_.segments.back().transition = transition;
      path_.segments.push_back(
          {.clip_idx = transition.target_clip, .first_frame = transition.arrive(), .transition = {}});
    }
  }

  const Case& case_;
  std::vector<Leg> legs_;
  MotionPath path_;
};

}  // namespace reprise::test
