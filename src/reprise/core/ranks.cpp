// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/ranks.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "reprise/core/error.h"

#ifdef REPRISE_WITH_MPI
// The C interface alone: the C++ bindings are gone from MPI since its version 3.
#define OMPI_SKIP_MPICXX
#define MPICH_SKIP_MPICXX
#include <mpi.h>
#endif

namespace reprise {
namespace {

bool is_alive = false;
int rank_index = 0;
int rank_count = 1;

// How many processes a launcher says it has started; 0: there is none.
int announced_ranks() {
  // Open MPI's mpirun; MPICH's Hydra and Slurm's PMI.
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* text = std::getenv(name);
    if (text != nullptr) return std::max(1, std::atoi(text));
  }
  // PMIx tells the number only when asked.
  return std::getenv("PMIX_RANK") != nullptr ? 1 : 0;
}

}  // namespace

int Ranks::index() {
  return rank_index;
}

int Ranks::count() {
  return rank_count;
}

#ifdef REPRISE_WITH_MPI

namespace {

constexpr auto patience = std::chrono::seconds(5);
// An MPI count is an int; larger contributions go in pieces.
constexpr std::size_t largest_message = std::size_t{1} << 28U;

bool has_mpi = false;
// For `all_failed`, so that it never meets another exchange half-way.
MPI_Comm failures = MPI_COMM_NULL;

void check(int result, const char* what) {
  if (result != MPI_SUCCESS) throw Error(fmt::format("MPI: {} failed with code {}", what, result));
}

}  // namespace

Ranks::Ranks() {
  if (is_alive) throw InvalidArgument("MPI is started once a process: there is an object of Ranks already");
  // A start of MPI costs a good part of a second, which a single process need not pay.
  if (announced_ranks() > 0) {
    int level = 0;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level), "the start");
    has_mpi = true;
    check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_index), "asking for the rank");
    check(MPI_Comm_size(MPI_COMM_WORLD, &rank_count), "asking for the number of ranks");
    check(MPI_Comm_dup(MPI_COMM_WORLD, &failures), "copying the communicator");
  }
  is_alive = true;
}

Ranks::~Ranks() {
  if (has_mpi) {
    MPI_Comm_free(&failures);
    MPI_Finalize();
  }
  has_mpi = false;
  is_alive = false;
  rank_index = 0;
  rank_count = 1;
}

std::vector<std::vector<std::byte>> Ranks::all_gather(std::span<const std::byte> contribution) {
  std::vector<std::vector<std::byte>> all(static_cast<std::size_t>(rank_count));
  if (rank_count == 1) {
    all[0].assign(contribution.begin(), contribution.end());
    return all;
  }
  const std::uint64_t size = contribution.size();
  std::vector<std::uint64_t> sizes(all.size());
  check(MPI_Allgather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD),
        "an exchange of sizes");
  for (int r = 0; r < rank_count; ++r) {
    std::vector<std::byte>& part = all[static_cast<std::size_t>(r)];
    if (r == rank_index) {
      part.assign(contribution.begin(), contribution.end());
    } else {
      part.resize(sizes[static_cast<std::size_t>(r)]);
    }
    for (std::size_t first = 0; first < part.size(); first += largest_message) {
      const auto length = static_cast<int>(std::min(largest_message, part.size() - first));
      check(MPI_Bcast(part.data() + first, length, MPI_BYTE, r, MPI_COMM_WORLD), "an exchange");
    }
  }
  return all;
}

bool Ranks::all_failed() {
  if (rank_count == 1) return true;
  MPI_Request request = MPI_REQUEST_NULL;
  if (MPI_Ibarrier(failures, &request) != MPI_SUCCESS) return false;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  int is_complete = 0;
  while (is_complete == 0 && std::chrono::steady_clock::now() < deadline) {
    if (MPI_Test(&request, &is_complete, MPI_STATUS_IGNORE) != MPI_SUCCESS) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return is_complete != 0;
}

void Ranks::abort(int exit_code) {
  if (has_mpi) MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

#else

Ranks::Ranks() {
  if (is_alive) throw InvalidArgument("there is an object of Ranks already");
  // Each of them would believe to be alone, and do all the work.
  if (const int ranks = announced_ranks(); ranks > 1) {
    throw InvalidArgument(fmt::format(
        "was started as one of {} MPI ranks, but was built without MPI: install libopenmpi-dev and "
        "configure with -DREPRISE_WITH_MPI=ON, or start it alone",
        ranks));
  }
  is_alive = true;
}

Ranks::~Ranks() {
  is_alive = false;
}

std::vector<std::vector<std::byte>> Ranks::all_gather(std::span<const std::byte> contribution) {
  return {{contribution.begin(), contribution.end()}};
}

bool Ranks::all_failed() {
  return true;
}

void Ranks::abort(int exit_code) {
  std::_Exit(exit_code);
}

#endif

}  // namespace reprise
