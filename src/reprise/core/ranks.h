// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Work shared by several processes: MPI ranks under `mpirun`, otherwise this process alone.

#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace reprise {

// Every rank runs the same program on the same input and takes its share of independent items; results are
// exchanged, so that all ranks go on with the same state. Without MPI at build time, or outside of `mpirun`,
// there is one rank and nothing to exchange. Exchanges are made by the thread that made the object.
class Ranks {
 public:
  // Starts MPI if the process was started by `mpirun` (or another launcher that names itself in the
  // environment as MPI's do); ends it at destruction. At most one object a process; throws `InvalidArgument`
  // otherwise. A launcher of several ranks of a program without MPI cannot work, and throws as well.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  // The ranks of this process: a single one if no object of this class is alive.
  static int index();
  static int count();
  static bool is_first() { return index() == 0; }

  // Everything every rank has contributed, in order of rank. All ranks must call it.
  static std::vector<std::vector<std::byte>> all_gather(std::span<const std::byte> contribution);

  // For a rank that cannot go on, before it ends: true if all ranks came here within a few seconds, because
  // the error is one of their common input, say; all may then end as usual. False: the others work on and
  // would wait for this rank for ever; it should say what happened and call `abort`.
  static bool all_failed();
  // Ends all ranks at once with this exit code.
  [[noreturn]] static void abort(int exit_code);
};

}  // namespace reprise
