// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small steps that readers of HDF5 groups share.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "reprise/core/error.h"
#include "reprise/io/hdf5.h"

namespace reprise {

// A one-dimensional array of `rows` numbers.
template <typename T>
std::vector<T> read_column(const Hdf5Group& group, const std::string& name, std::size_t rows) {
  const Hdf5Dataset dataset = group.dataset(name);
  dataset.check_shape({rows});
  return dataset.read<T>();
}

// Runs `check`. A broken precondition found in a file is the file's fault: its `InvalidArgument` becomes a
// `FileError` that names the group.
template <typename Check>
void check_contents(const Hdf5Group& group, const Check& check) {
  try {
    check();
  } catch (const InvalidArgument& error) {
    throw FileError(group.file_path(), group.name(), error.what());
  }
}

}  // namespace reprise
