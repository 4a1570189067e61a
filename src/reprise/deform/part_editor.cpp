// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_editor.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/deform/learnt_part_solver.h"
#include "reprise/deform/part_alignment.h"
#include "reprise/math/nearest_rotation.h"

namespace reprise {
namespace {

std::vector<BodyPart> parts_of(const TopologyPtr& topology, const LearntModel& learnt) {
  if (!topology) throw InvalidArgument("a learnt model needs a topology");
  if (learnt.parts.empty()) throw InvalidArgument("the learnt model has no parts");
  validate(learnt, topology->vertex_count);
  std::vector<BodyPart> parts;
  for (const LearntPart& part : learnt.parts) parts.push_back(part.part);
  return parts;
}

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

// What a part is asked for: its own constraints and what it shares with its parent.
struct Demand {
  std::vector<PartConstraint> constraints;  // ascending by vertex
  std::vector<Eigen::Vector3d> targets;

  // Two demands on one vertex are one on their weighted mean.
  void add(std::int32_t local, double squared_weight, const Eigen::Vector3d& target) {
    const auto found = std::ranges::lower_bound(constraints, local, {}, &PartConstraint::local);
    const auto at = targets.begin() + (found - constraints.begin());
    if (found != constraints.end() && found->local == local) {
      const double sum = found->squared_weight + squared_weight;
      *at = (found->squared_weight * *at + squared_weight * target) / sum;
      found->squared_weight = sum;
      return;
    }
    targets.insert(at, target);
    constraints.insert(found, {.local = local, .squared_weight = squared_weight});
  }
};

// The rotation that takes the constrained places of the frame to their targets best; if they do not move
// rigidly, the best one about the vertical, since limbs that swing would tilt the torso.
Eigen::Matrix3d turn_of(std::span<const PositionConstraint> constraints, const Coordinates& frame) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (const PositionConstraint& constraint : constraints) {
    const double weight = constraint.weight * constraint.weight;
    from += weight * frame.row(constraint.vertex).transpose();
    to += weight * constraint.target;
    total += weight;
  }
  from /= total;
  to /= total;
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (const PositionConstraint& constraint : constraints) {
    M += constraint.weight * constraint.weight * (constraint.target - to) *
         (frame.row(constraint.vertex) - from.transpose());
  }
  // One or two constraints leave turns open: those are not made.
  constexpr double still = 1e-9;
  const Eigen::Matrix3d any = nearest_rotation(M + (still * M.norm() + 1e-30) * Eigen::Matrix3d::Identity());
  double squares = 0.0;
  double extent = 0.0;
  for (const PositionConstraint& constraint : constraints) {
    const double weight = constraint.weight * constraint.weight;
    const Eigen::Vector3d wanted = constraint.target - to;
    squares += weight * (wanted - any * (frame.row(constraint.vertex).transpose() - from)).squaredNorm();
    extent += weight * wanted.squaredNorm();
  }
  constexpr double rigid_share = 1e-4;  // one percent of the extent
  if (squares <= rigid_share * extent) return any;
  const double along = M(0, 0) + M(2, 2);
  const double across = M(0, 2) - M(2, 0);
  if (std::hypot(along, across) <= still * (M.norm() + 1e-30)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(std::atan2(across, along), Eigen::Vector3d::UnitY()).toRotationMatrix();
}

}  // namespace

PartModel::PartModel(TopologyPtr topology, const LearntModel& learnt, const PartEditorOptions& options)
    : hierarchy_(topology, view(learnt.reference), parts_of(topology, learnt)), options_(options) {
  const auto check = [](const char* name, double value) {
    if (!(value > 0.0 && value < 1e6))
      throw InvalidArgument(fmt::format("{}: expected a positive number, found {}", name, value));
  };
  check("constraint_weight", options.constraint_weight);
  check("frontier_weight", options.frontier_weight);
  check("resting_frontier_weight", options.resting_frontier_weight);
  if (!(options.free_turn >= 0.0))
    throw InvalidArgument(fmt::format("free_turn: expected 0 or more, found {}", options.free_turn));
  if (!(options.prior >= 0.0))
    throw InvalidArgument(fmt::format("prior: expected 0 or more, found {}", options.prior));

  solvers_.resize(learnt.parts.size());
  parallel_for(0, solvers_.size(), [&](std::size_t p) {
    const PartHierarchy::Part& part = hierarchy_.part(static_cast<int>(p));
    if (part.vertices.size() != learnt.parts[p].part.vertices.size()) {
      throw InvalidArgument(
          fmt::format("part '{}' of the learnt model holds vertices that no triangle has", part.name));
    }
    solvers_[p] = std::make_unique<LearntPartSolver>(part, learnt.reference, learnt.parts[p], options_);
  });
  const double edge_length = mean_edge_length(*topology, view(learnt.reference));
  if (edge_length > 0.0) edge_length_ = edge_length;
}

PartModel::~PartModel() = default;

// What is kept of a part from one drag to the next.
struct PartEditor::PartState {
  std::optional<LearntPartSolver::Frame> frame;  // made when the part is first solved
  std::optional<LearntPartSolver::Factorization> factorization;
  std::optional<LearntPartSolver::Prepared> prepared;
};

PartEditor::PartEditor(std::shared_ptr<const PartModel> model)
    : model_(std::move(model)), states_(model_->hierarchy().parts().size()) {
  part_positions_.resize(states_.size());
  changes_.resize(states_.size());
}

PartEditor::~PartEditor() = default;

void PartEditor::set_frame(const PositionsView& frame, const SkeletonPose* /*pose*/) {
  check_frame(frame, model_->hierarchy().vertex_count());
  frame_ = frame.cast<double>();
  positions_ = frame_;
  for (PartState& state : states_) {
    state.frame.reset();
    state.prepared.reset();
  }
}

void PartEditor::prefer(std::vector<Eigen::VectorXd> changes) {
  if (!changes.empty() && changes.size() != states_.size()) {
    throw InvalidArgument(
        fmt::format("preferred coefficients of {} parts; the model has {}", changes.size(), states_.size()));
  }
  for (std::size_t p = 0; p < changes.size(); ++p) {
    const Eigen::Index expected = model_->solvers_[p]->component_count();
    if (changes[p].size() != expected || !changes[p].allFinite()) {
      throw InvalidArgument(
          fmt::format("preferred coefficients of part '{}': expected {} finite numbers, found {}",
                      model_->hierarchy().part(static_cast<int>(p)).name, expected, changes[p].size()));
    }
  }
  preferred_ = std::move(changes);
}

DeformReport PartEditor::deform(std::span<const PositionConstraint> constraints) {
  const PartHierarchy& hierarchy = model_->hierarchy();
  check_constraints(constraints, hierarchy.vertex_count(), frame_);
  constexpr double least_share = 0.05;
  const double unit = 1.0 / (model_->edge_length_ * model_->edge_length_);
  const double constraint_weight = model_->options().constraint_weight;

  std::vector<Demand> demands(states_.size());
  std::vector<char> is_asked(states_.size(), 0);
  std::vector<char> is_moved(states_.size(), 0);
  for (const PositionConstraint& constraint : constraints) {
    is_asked[static_cast<std::size_t>(hierarchy.main_part(constraint.vertex))] = 1;
  }
  for (const PositionConstraint& constraint : constraints) {
    for (const PartHierarchy::Share& share : hierarchy.shares(constraint.vertex)) {
      const auto p = static_cast<std::size_t>(share.part_idx);
      const double weight = constraint_weight * constraint.weight * share.weight;
      if (is_asked[p] == 0 || !(share.weight >= least_share)) continue;
      demands[p].add(share.local, unit * weight * weight, constraint.target);
      if (constraint.target != frame_.row(constraint.vertex).transpose()) is_moved[p] = 1;
    }
  }

  // Where its constraints leave the turn of a part open, it turns as all of them together say.
  const Eigen::Matrix3d common_turn = turn_of(constraints, frame_);
  // Whether anything asks a part or one above it.
  std::vector<char> may_move = is_asked;
  DeformReport report;
  positions_ = frame_;
  for (std::size_t p = 0; p < states_.size(); ++p) {
    const PartHierarchy::Part& part = hierarchy.parts()[p];
    const LearntPartSolver& solver = *model_->solvers_[p];
    PartState& state = states_[p];
    changes_[p].setZero(solver.component_count());
    part_positions_[p] = frame_(part.vertices, Eigen::all);
    const auto parent = static_cast<std::size_t>(std::max(part.parent, 0));
    if (part.parent >= 0) {
      may_move[p] |= may_move[parent];
      is_moved[p] |= is_moved[parent];
    }
    if (is_moved[p] == 0) continue;

    Demand& demand = demands[p];
    const double frontier_weight =
        may_move[parent] != 0 ? model_->options().frontier_weight : model_->options().resting_frontier_weight;
    for (const PartHierarchy::FrontierVertex& shared : part.frontier) {
      const double weight = frontier_weight * shared.parent_share;
      if (!(weight > 0.0)) continue;
      demand.add(shared.local, unit * weight * weight,
                 part_positions_[parent].row(shared.parent_local).transpose());
    }
    if (!state.frame) state.frame = solver.frame(part_positions_[p]);
    if (!state.factorization || state.factorization->constraints != demand.constraints) {
      state.factorization = solver.factorize(std::move(demand.constraints));
      state.prepared.reset();
    }
    if (!state.prepared) state.prepared = solver.prepare(*state.factorization, *state.frame);
    LearntPartSolver::Solution solution =
        solver.solve(*state.factorization, *state.frame, *state.prepared, demand.targets, common_turn,
                     preferred_.empty() ? Eigen::VectorXd() : preferred_[p]);
    part_positions_[p] = std::move(solution.positions);
    changes_[p] = std::move(solution.changes);
    ++report.solved_parts;
    report.iterations = std::max(report.iterations, solution.iterations);
  }
  for (std::size_t p = 0; p < states_.size(); ++p) {
    if (is_moved[p] != 0) hierarchy.recombine(part_positions_, hierarchy.parts()[p].vertices, positions_);
  }
  report.largest_residual = largest_residual(constraints, positions_);
  return report;
}

}  // namespace reprise
