// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/database_model.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "reprise/io/database_markup.h"
#include "reprise/io/hdf5_contents.h"

namespace reprise {
namespace {

// Rows of numbers, one chunk a row, each with its checksum: a flipped bit is found. Not deflated: that saves
// 11 % of them and takes ten times as long to read.
void write_rows(Hdf5Group& group, const char* name, const Hdf5Shape& shape, const float* values) {
  Hdf5DatasetOptions options{.chunk_rows = 1, .checksum = true};
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  if (shape.size() == 1) options.chunk_rows = size;
  if (size == 0) options = {};  // HDF5 has no empty chunks
  group.create_dataset(name, Hdf5Type::float32, shape, options)
      .write<float>(Hdf5Shape(shape.size(), 0), shape, std::span(values, size));
}

void write_vector(Hdf5Group& group, const char* name, const Eigen::VectorXd& values) {
  const auto size = static_cast<std::size_t>(values.size());
  group.write<double>(name, {size}, std::span(values.data(), size));
}

Eigen::VectorXd read_vector(const Hdf5Group& group, const char* name, std::size_t size) {
  const std::vector<double> values = read_column<double>(group, name, size);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(size));
}

void write_part(Hdf5Group& group, const LearntPart& learnt) {
  const auto size = static_cast<std::size_t>(learnt.mean.size());
  write_rows(group, "mean", {size}, learnt.mean.data());
  // Columns lie one after the other in memory: a component a row of the file.
  write_rows(group, "basis", {static_cast<std::size_t>(learnt.basis.cols()), size}, learnt.basis.data());
  write_vector(group, "deviations", learnt.deviations);
  write_vector(group, "least", learnt.least);
  write_vector(group, "greatest", learnt.greatest);
  group.write_text_dataset("examples", std::span<const std::string>(learnt.examples));
  group.write_number("discarded_variance", learnt.discarded_variance);
  group.write_number("total_variance", learnt.total_variance);
}

LearntPart read_part(const Hdf5Group& group, BodyPart part) {
  LearntPart learnt{.part = std::move(part)};
  const std::size_t size = 3 * learnt.part.vertices.size();
  const auto rows = static_cast<Eigen::Index>(size);
  const Hdf5Dataset mean = group.dataset("mean", 0);
  mean.check_shape({size});
  learnt.mean.resize(rows);
  mean.read<float>({0}, {size}, std::span(learnt.mean.data(), size));
  const Hdf5Dataset basis = group.dataset("basis", 0);
  const std::size_t components = basis.shape().empty() ? 0 : basis.shape().front();
  basis.check_shape({components, size});
  learnt.basis.resize(rows, static_cast<Eigen::Index>(components));
  basis.read<float>({0, 0}, {components, size}, std::span(learnt.basis.data(), components * size));
  learnt.deviations = read_vector(group, "deviations", components);
  learnt.least = read_vector(group, "least", components);
  learnt.greatest = read_vector(group, "greatest", components);
  learnt.examples = group.dataset("examples").read_texts();
  learnt.discarded_variance = group.read_number("discarded_variance");
  learnt.total_variance = group.read_number("total_variance");
  return learnt;
}

void write_model(Hdf5Group& group, const LearntModel& model) {
  const auto n = static_cast<std::size_t>(model.reference.rows());
  group.write<float>("reference", {n, 3}, std::span(model.reference.data(), n * 3));
  std::vector<BodyPart> parts;
  for (const LearntPart& learnt : model.parts) parts.push_back(learnt.part);
  write_parts(group, parts);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    Hdf5Group child = group.create_group(std::to_string(p));
    write_part(child, model.parts[p]);
  }
}

LearntModel read_model(const Hdf5Group& group, std::int32_t vertex_count) {
  const auto n = static_cast<std::size_t>(vertex_count);
  LearntModel model;
  const Hdf5Dataset reference = group.dataset("reference");
  reference.check_shape({n, 3});
  model.reference.resize(vertex_count, 3);
  reference.read<float>({0, 0}, {n, 3}, std::span(model.reference.data(), n * 3));
  std::vector<BodyPart> parts = read_parts(group);
  // Before anything is read whose size they tell.
  check_contents(group, [&] { validate(parts, vertex_count); });
  for (std::size_t p = 0; p < parts.size(); ++p) {
    model.parts.push_back(read_part(group.group(std::to_string(p)), std::move(parts[p])));
  }
  return model;
}

}  // namespace

void write_models(Hdf5Group& group, const LearntModels& models) {
  for (const auto& [name, model] : {std::pair("part", &models.part), std::pair("whole", &models.whole)}) {
    if (model->parts.empty()) continue;
    Hdf5Group child = group.create_group(name);
    write_model(child, *model);
  }
}

LearntModels read_models(const Hdf5Group& group, std::int32_t vertex_count) {
  LearntModels models;
  if (group.has("whole")) {
    const Hdf5Group child = group.group("whole");
    models.whole = read_model(child, vertex_count);
    check_contents(child, [&] { validate(models, vertex_count); });
  }
  if (group.has("part")) {
    const Hdf5Group child = group.group("part");
    models.part = read_model(child, vertex_count);
    check_contents(child, [&] { validate(models.part, vertex_count); });
  }
  return models;
}

}  // namespace reprise
