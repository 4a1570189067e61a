// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/linalg/sparse_cholesky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include <cholmod.h>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// Four right-hand sides side by side: one vector register, and three coordinates fit with one lane to spare.
using Lanes = Eigen::Array<double, 4, 1>;
// Columns of a panel: their intermediate results must stay in registers.
constexpr int max_panel_width = 8;

// Neighbouring columns of L with the same rows below the diagonal. Solving by panels loads every row index
// and every row of the right-hand sides once per panel instead of once per entry of L.
struct Panel {
  std::int32_t first_column = 0;
  std::int32_t width = 0;
  std::int32_t row_count = 0;  // below the dense triangle
  std::size_t rows_begin = 0;  // into `rows`
  std::size_t values_begin =
      0;  // into `values`: width x width triangle, then row_count x width, both row-major
};

template <int width>
void forward(const Panel& panel, const std::int32_t* rows, const double* values, Lanes* x) {
  Lanes y[width];
  Lanes* own = x + panel.first_column;
  for (int r = 0; r < width; ++r, values += width) {
    Lanes sum = own[r];
    for (int k = 0; k < r; ++k) sum -= values[k] * y[k];
    own[r] = y[r] = sum * values[r];  // the diagonal is stored inverted
  }
  for (std::int32_t i = 0; i < panel.row_count; ++i, values += width) {
    Lanes sum = x[rows[i]];
    for (int k = 0; k < width; ++k) sum -= values[k] * y[k];
    x[rows[i]] = sum;
  }
}

template <int width>
void backward(const Panel& panel, const std::int32_t* rows, const double* values, Lanes* x) {
  Lanes y[width];
  Lanes* own = x + panel.first_column;
  for (int k = 0; k < width; ++k) y[k] = own[k];
  const double* below = values + std::ptrdiff_t{width} * width;
  for (std::int32_t i = 0; i < panel.row_count; ++i, below += width) {
    const Lanes row = x[rows[i]];
    for (int k = 0; k < width; ++k) y[k] -= below[k] * row;
  }
  for (int r = width - 1; r >= 0; --r) {
    y[r] *= values[r * width + r];
    for (int k = 0; k < r; ++k) y[k] -= values[r * width + k] * y[r];
    own[r] = y[r];
  }
}

using Kernel = void (*)(const Panel&, const std::int32_t*, const double*, Lanes*);
constexpr Kernel forward_kernels[max_panel_width] = {forward<1>, forward<2>, forward<3>, forward<4>,
                                                     forward<5>, forward<6>, forward<7>, forward<8>};
constexpr Kernel backward_kernels[max_panel_width] = {backward<1>, backward<2>, backward<3>, backward<4>,
                                                      backward<5>, backward<6>, backward<7>, backward<8>};

// CHOLMOD's workspace and settings, for the factorisation alone.
class Cholmod {
 public:
  Cholmod() {
    cholmod_start(&common);
    // The supernodal module and `cholmod_sdmult` are GPL; the simplicial factorisation is LGPL. So the choice
    // is never left to CHOLMOD, and nothing but analyze and factorize is called.
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_super = 0;
    common.final_ll = 1;
    common.final_monotonic = 1;
    common.print = 0;
    // Minimum degree has less fill on small meshes, nested dissection on large ones: both are tried and the
    // sparser factor is taken. The analysis is done once and every solve gains.
    common.nmethods = 2;
    common.method[0].ordering = CHOLMOD_AMD;
    common.method[1].ordering = CHOLMOD_METIS;
    common.postorder = 1;  // makes columns of equal structure neighbours
  }
  ~Cholmod() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common common = {};
  cholmod_factor* factor = nullptr;
};

// METIS takes over the handlers of SIGTERM and SIGABRT while it runs and gives back what it found: two runs at
// a time leave its own behind, which jumps to a frame that is gone. So one analysis runs at a time.
cholmod_factor* analyze(cholmod_sparse& matrix, cholmod_common& common) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  return cholmod_analyze(&matrix, &common);
}

}  // namespace

struct SparseCholesky::Impl {
  std::vector<std::int32_t> row_of_pivot;
  std::vector<Panel> panels;
  std::vector<std::int32_t> rows;
  std::vector<double> values;
  Eigen::Index factor_nonzeros = 0;

  void build_panels(const cholmod_factor& L) {
    const auto n = static_cast<std::int32_t>(L.n);
    const auto* begin = static_cast<const std::int32_t*>(L.p);
    const auto* count = static_cast<const std::int32_t*>(L.nz);
    const auto* row = static_cast<const std::int32_t*>(L.i);
    const auto* value = static_cast<const double*>(L.x);
    for (std::int32_t j = 0; j < n;) {
      Panel panel{.first_column = j, .width = 1, .rows_begin = rows.size(), .values_begin = values.size()};
      // Column k + 1 has the rows of column k without k + 1 itself exactly if k + 1 is the first of them and
      // the counts agree: in a Cholesky factor the rows of a column are among those of its first off-diagonal
      // row.
      for (std::int32_t k = j; panel.width < max_panel_width && count[k] > 1 && row[begin[k] + 1] == k + 1 &&
                               count[k + 1] == count[k] - 1;
           ++k) {
        ++panel.width;
      }
      panel.row_count = count[j] - panel.width;
      const std::int32_t* below = row + begin[j] + panel.width;
      rows.insert(rows.end(), below, below + panel.row_count);
      values.resize(values.size() + static_cast<std::size_t>((panel.width + panel.row_count) * panel.width),
                    0.0);
      double* out = values.data() + panel.values_begin;
      for (std::int32_t k = 0; k < panel.width; ++k) {
        const double* column = value + begin[j + k];
        out[k * panel.width + k] = 1.0 / column[0];
        for (std::int32_t r = k + 1; r < panel.width + panel.row_count; ++r)
          out[r * panel.width + k] = column[r - k];
        factor_nonzeros += count[j + k];
      }
      panels.push_back(panel);
      j += panel.width;
    }
  }

  void solve(Lanes* x) const {
    for (const Panel& panel : panels) {
      forward_kernels[panel.width - 1](panel, rows.data() + panel.rows_begin,
                                       values.data() + panel.values_begin, x);
    }
    for (auto panel = panels.rbegin(); panel != panels.rend(); ++panel) {
      backward_kernels[panel->width - 1](*panel, rows.data() + panel->rows_begin,
                                         values.data() + panel->values_begin, x);
    }
  }

  template <typename Matrix>
  void solve_columns(Matrix& b) const {
    const auto n = static_cast<Eigen::Index>(row_of_pivot.size());
    if (b.rows() != n) {
      throw InvalidArgument(
          fmt::format("right-hand side has {} rows, the factorised matrix {}", b.rows(), n));
    }
    // Kept per thread: freshly mapped pages can cost more than the solve.
    thread_local std::vector<Lanes> x;
    x.resize(row_of_pivot.size());
    for (Eigen::Index first = 0; first < b.cols(); first += Lanes::SizeAtCompileTime) {
      const Eigen::Index columns = std::min<Eigen::Index>(Lanes::SizeAtCompileTime, b.cols() - first);
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i].setZero();
        for (Eigen::Index k = 0; k < columns; ++k) x[i][k] = b(row_of_pivot[i], first + k);
      }
      solve(x.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        for (Eigen::Index k = 0; k < columns; ++k) b(row_of_pivot[i], first + k) = x[i][k];
      }
    }
  }
};

SparseCholesky::SparseCholesky() : impl_(std::make_unique<Impl>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

SparseCholesky::SparseCholesky(const Eigen::SparseMatrix<double>& A) : SparseCholesky() {
  if (A.rows() != A.cols()) {
    throw InvalidArgument(fmt::format("Cholesky needs a square matrix, found {} x {}", A.rows(), A.cols()));
  }
  if (A.rows() == 0) return;
  Eigen::SparseMatrix<double> lower = A.triangularView<Eigen::Lower>();
  lower.makeCompressed();
  std::vector<double> diagonal(static_cast<std::size_t>(A.rows()), 0.0);
  for (Eigen::Index j = 0; j < lower.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, j); entry; ++entry) {
      if (!std::isfinite(entry.value())) {
        throw InvalidArgument(fmt::format("Cholesky needs finite entries: entry ({}, {}) is {}", entry.row(),
                                          entry.col(), entry.value()));
      }
      if (entry.row() == entry.col()) diagonal[static_cast<std::size_t>(j)] = entry.value();
    }
  }

  Cholmod cholmod;
  cholmod_sparse view = {};
  view.nrow = view.ncol = static_cast<std::size_t>(lower.rows());
  view.nzmax = static_cast<std::size_t>(lower.nonZeros());
  view.p = lower.outerIndexPtr();
  view.i = lower.innerIndexPtr();
  view.x = lower.valuePtr();
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  cholmod.factor = analyze(view, cholmod.common);
  if (cholmod.factor != nullptr) cholmod_factorize(&view, cholmod.factor, &cholmod.common);
  if (cholmod.factor == nullptr || cholmod.common.status < CHOLMOD_OK) {
    throw Error(fmt::format("CHOLMOD cannot factorise a {0} x {0} matrix with {1} entries (status {2})",
                            lower.rows(), lower.nonZeros(), cholmod.common.status));
  }

  const cholmod_factor& L = *cholmod.factor;
  const auto* permutation = static_cast<const std::int32_t*>(L.Perm);
  const auto* begin = static_cast<const std::int32_t*>(L.p);
  for (std::size_t k = 0; k < L.n; ++k) {
    // A singular matrix often passes with a pivot of rounding error only, and would then return noise.
    constexpr double smallest_pivot = 1e-14;
    const double scale = diagonal[static_cast<std::size_t>(permutation[k])];
    const double pivot = k < L.minor ? static_cast<const double*>(L.x)[begin[k]] : 0.0;
    if (k >= L.minor || !(pivot * pivot > smallest_pivot * scale)) {
      throw InvalidArgument(fmt::format(
          "matrix is not positive definite: the pivot of row {} (number {} of {} in elimination order) is "
          "not positive; its diagonal entry is {}",
          permutation[k], k + 1, L.n, scale));
    }
  }
  impl_->row_of_pivot.assign(permutation, permutation + L.n);
  impl_->build_panels(L);
}

Eigen::Index SparseCholesky::size() const {
  return impl_ == nullptr ? 0 : static_cast<Eigen::Index>(impl_->row_of_pivot.size());
}

Eigen::Index SparseCholesky::factor_nonzeros() const {
  return impl_ == nullptr ? 0 : impl_->factor_nonzeros;
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = b;
  if (impl_ == nullptr) throw InvalidArgument("this factorisation has been moved from");
  impl_->solve_columns(x);
  return x;
}

void SparseCholesky::solve_in_place(Eigen::Ref<RowMajorMatrix> b) const {
  if (impl_ == nullptr) throw InvalidArgument("this factorisation has been moved from");
  impl_->solve_columns(b);
}

}  // namespace reprise
