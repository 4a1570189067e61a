// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Learnt models in the database file (format version 3).

#pragma once

#include <cstdint>

#include "reprise/database/learnt_model.h"
#include "reprise/io/hdf5.h"

namespace reprise {

// `group`: "model" itself, new or read; a model without parts is left out. What is written has been
// validated. The reader throws `FileError` naming the object for what is damaged or does not fit; numbers of
// means and bases carry a checksum.
void write_models(Hdf5Group& group, const LearntModels& models);
LearntModels read_models(const Hdf5Group& group, std::int32_t vertex_count);

}  // namespace reprise
