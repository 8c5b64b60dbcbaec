#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/frozen_frame.hpp"

namespace compueye::recon::core {

// What a frozen frame consists of, once for the writer and the reader. An archive has number(value), kind(enumeration)
// and table(pointer, count), which for a table that is not there (null) takes no values. A field left out here is lost
// on the way: tests/recon/frozen_frame_test.cpp solves every setting once more from its bytes.

inline constexpr std::uint64_t frozen_magic = 0x4559454E5A4F5246;  // "FROZNEYE"
inline constexpr std::uint64_t frozen_version = 3;                 // goes up whenever this file changes
inline constexpr std::size_t frozen_alignment = 64;

template <class Archive>
void describe(DctTable<float>& table, Archive& archive) {
  archive.number(table.length);
  archive.table(table.values, table.length == 0 ? 0 : DctTable<float>::size(table.length));
}

template <class Archive>
void describe(Dct2d<float>& dct, Archive& archive) {
  describe(dct.rows, archive);
  describe(dct.cols, archive);
}

template <class Archive>
void describe(RunningSums<float>& sums, Archive& archive) {
  archive.number(sums.rows_at_once);
  archive.number(sums.image_rows);
  archive.number(sums.image_cols);
  archive.number(sums.tables);
  archive.number(sums.bands);
  const std::size_t pieces = 4 * sums.tables * sums.bands;
  archive.table(sums.first, pieces + 1);
  const std::size_t taps = sums.first == nullptr ? 0 : sums.first[pieces];
  archive.table(sums.element, taps);
  archive.table(sums.difference, taps);
  archive.table(sums.row, sums.rows_at_once > 1 ? sums.rows_at_once * sums.tables : 0);
  archive.table(sums.band_row, sums.bands + 1);
}

template <class Archive>
void describe(DenseRuns<float>& runs, Archive& archive) {
  archive.kind(runs.stored);
  archive.number(runs.blocks);
  archive.number(runs.bands);
  const std::size_t pieces = runs.blocks * runs.bands;
  archive.table(runs.first, pieces + 1);
  archive.table(runs.group, pieces + 1);
  const std::size_t count = runs.first == nullptr ? 0 : runs.first[pieces];
  const std::size_t groups = runs.group == nullptr ? 0 : runs.group[pieces];
  archive.table(runs.start, count);
  archive.table(runs.groups, count);
  constexpr std::size_t rows = DenseRuns<float>::rows_at_once, entries = rows * DenseRuns<float>::group_pixels;
  archive.table(runs.row, rows * runs.blocks);
  archive.table(runs.values, runs.stored == RunValues::full ? entries * groups : 0);
  archive.table(runs.words, runs.stored == RunValues::bf16 ? entries / 2 * groups : entries / 4 * groups);
  archive.table(runs.scale, rows * runs.blocks);
}

template <class Archive>
void describe(DeflatedStep<float>& step, Archive& archive) {
  archive.number(step.order);
  archive.number(step.classes);
  archive.number(step.levels);
  archive.table(step.images, step.order);
  for (auto& part : step.parts) {
    archive.number(part.order);
    archive.number(part.rank);
    archive.number(part.refined);
    archive.table(part.vectors, part.order * part.columns());
    archive.table(part.gains, step.levels * part.rank);
    archive.table(part.rest, step.levels);
    archive.table(part.index, step.order);
    archive.table(part.share, step.order);
  }
}

template <class Archive>
void describe(LinearOperator<float>& a, Archive& archive) {
  archive.kind(a.kind);
  archive.number(a.rows);
  archive.number(a.cols);
  const bool sparse = a.kind == OperatorKind::csr, dense = a.kind == OperatorKind::dense;
  archive.table(a.row_start, sparse ? a.rows + 1 : 0);
  const std::size_t entries = sparse && a.row_start != nullptr ? a.row_start[a.rows] : 0;
  archive.table(a.columns, entries);
  archive.table(a.values, dense ? a.rows * a.cols : entries);
  describe(a.sums, archive);
  describe(a.runs, archive);
}

template <class Archive>
void describe(ClassInverse<float>& inverse, Archive& archive) {
  archive.number(inverse.order);
  archive.number(inverse.classes);
  for (auto& part : inverse.parts) {
    archive.number(part.matrix.order);
    archive.table(part.matrix.values, PackedSymmetric<float>::size(part.matrix.order));
    archive.table(part.index, inverse.order);
    archive.table(part.share, inverse.order);
  }
}

template <class Archive>
void describe(ThinStep<float>& step, Archive& archive) {
  archive.number(step.rows);
  archive.number(step.cols);
  archive.number(step.lanes);
  archive.number(step.levels);
  archive.table(step.turned, step.rows * step.cols);
  archive.table(step.gains, step.levels * step.rows * step.lanes);
  archive.table(step.rotation, step.rows * step.rows * step.lanes);
  archive.table(step.pixel, step.lanes == 4 ? step.cols : 0);
  archive.table(step.image, step.lanes == 4 ? 4 * step.rows : 0);
}

template <class Archive>
void describe(Basis<float>& psi, Archive& archive) {
  archive.kind(psi.kind);
  archive.number(psi.rows);
  archive.number(psi.cols);
  describe(psi.dct, archive);
  archive.number(psi.fourier.rows);
  archive.number(psi.fourier.cols);
  archive.table(psi.fourier.row_table, psi.fourier.rows * psi.fourier.rows);
  archive.table(psi.fourier.col_table, psi.fourier.cols * psi.fourier.cols);
}

template <class Archive>
void describe(OperatingPoint& point, Archive& archive) {
  archive.kind(point.op);
  archive.kind(point.basis);
  archive.kind(point.solver);
  archive.kind(point.precision);
  archive.number(point.iterations);
}

template <class Archive>
void describe(FrameProblem<float>& problem, Archive& archive) {
  describe(problem.a, archive);
  describe(problem.inverse, archive);
  describe(problem.thin_step, archive);
  archive.table(problem.seeing, problem.a.rows);
  archive.number(problem.channels);
  archive.number(problem.max_reweighted);
  archive.number(problem.image_rows);
  archive.number(problem.image_cols);
  describe(problem.psi, archive);
  archive.table(problem.metric.inverse_eigenvalues, problem.a.cols);
  describe(problem.metric.dct, archive);
  archive.number(problem.constrained);
  archive.number(problem.lo);
  archive.number(problem.hi);
  archive.number(problem.lambda);
  archive.number(problem.rho);
  archive.number(problem.schedule.levels);
  archive.number(problem.schedule.iterations_a_level);
  archive.table(problem.schedule.penalty, problem.schedule.levels);
  archive.number(problem.relaxation);
  archive.number(problem.l1_reweighting);
  archive.number(problem.lipschitz);
  archive.table(problem.primal_steps, problem.a.cols);
  archive.table(problem.dual_steps, problem.a.rows);
  archive.number(problem.basis_step);
  describe(problem.dual_step, archive);
  archive.number(problem.bounded);
  archive.number(problem.epsilon);
  archive.number(problem.mean_row_sum);
  archive.number(problem.column_norm);
  archive.table(problem.atom_norms, problem.a.cols);
  archive.number(problem.modes.rank);
  archive.table(problem.modes.left, problem.a.rows * problem.modes.rank);
  archive.table(problem.modes.inverse_squares, problem.modes.rank);
  archive.number(problem.measure_gap);
  archive.number(problem.warm_start);
  describe(problem.point, archive);
}

template <class Archive>
void describe(FrozenFrame& frame, Archive& archive) {
  describe(frame.problem, archive);
  archive.table(frame.y, frame.problem.channels);
  archive.table(frame.weights, frame.problem.channels);
  archive.table(frame.picture, frame.problem.pixels());
  archive.number(frame.objective);
}

}  // namespace compueye::recon::core
