#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/deflated_step.hpp"
#include "recon/core/parts/penalty_schedule.hpp"
#include "recon/core/parts/thin_step.hpp"

namespace compueye::recon::core {

// What a frozen frame consists of, once for the writer and the reader. An archive has number(value), kind(enumeration)
// and table(pointer, count), which for a table that is not there (null) takes no values. A field left out here is lost
// on the way: tests/recon/frozen_frame_test.cpp solves every setting once more from its bytes.

inline constexpr std::uint64_t frozen_magic = 0x4559454E5A4F5246;  // "FROZNEYE"
inline constexpr std::uint64_t frozen_version = 6;  // goes up whenever this file, or a method's fields(), changes
inline constexpr std::size_t frozen_alignment = 64;
inline constexpr std::size_t frozen_name_words = 2;  // of eight characters, for the name of the method

/// Eight characters of a name, filled up with noughts.
[[nodiscard]] constexpr std::uint64_t frozen_name_word(std::string_view name, std::size_t word) noexcept {
  std::uint64_t value = 0;
  for (std::size_t k = 8 * word; k < 8 * word + 8 && k < name.size(); ++k) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(name[k])) << (8 * (k % 8));
  }
  return value;
}

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
void describe(WaveletRuns<float>& wavelet, Archive& archive) {
  archive.number(wavelet.picture.rows);
  archive.number(wavelet.picture.cols);
  archive.number(wavelet.blocks);
  archive.number(wavelet.bands);
  const std::size_t pieces = wavelet.blocks * wavelet.bands;
  const auto tiles = [&](WaveletRuns<float>::Tiles& list, std::size_t words) {
    archive.table(list.first, pieces + 1);
    const std::size_t count = list.first == nullptr ? 0 : list.first[pieces];
    archive.table(list.place, count);
    archive.table(list.words, words * count);
  };
  tiles(wavelet.averages, WaveletRuns<float>::average_words);
  tiles(wavelet.details, WaveletRuns<float>::detail_words);
  archive.table(wavelet.scale, WaveletRuns<float>::rows_at_once * wavelet.blocks);
  archive.table(wavelet.row, WaveletRuns<float>::rows_at_once * wavelet.blocks);
  archive.table(wavelet.band, wavelet.bands + 1);
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
  describe(a.wavelet, archive);
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
void describe(PackedSymmetric<double>& matrix, Archive& archive) {
  archive.number(matrix.order);
  archive.table(matrix.values, PackedSymmetric<double>::size(matrix.order));
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
void describe(PenaltySchedule<float>& schedule, Archive& archive) {
  archive.number(schedule.levels);
  archive.number(schedule.iterations_a_level);
  archive.table(schedule.penalty, schedule.levels);
}

/// What all methods share.
template <class Archive>
void describe(FrameProblem<float>& problem, Archive& archive) {
  describe(problem.a, archive);
  archive.table(problem.seeing, problem.a.rows);
  archive.number(problem.channels);
  archive.number(problem.max_reweighted);
  archive.number(problem.image_rows);
  archive.number(problem.image_cols);
  problem.psi.fields(archive);
  archive.table(problem.metric.inverse_eigenvalues, problem.a.cols);
  describe(problem.metric.dct, archive);
  archive.number(problem.constrained);
  archive.number(problem.lo);
  archive.number(problem.hi);
  archive.number(problem.lambda);
  archive.number(problem.bounded);
  archive.number(problem.epsilon);
  archive.number(problem.unit.samples);
  archive.number(problem.unit.picture);
  archive.number(problem.homogeneous);
  archive.number(problem.measure_gap);
  archive.kind(problem.point.op);
  archive.kind(problem.point.basis);
  archive.kind(problem.point.precision);
  archive.number(problem.point.iterations);
}

template <class Problem, class Samples, class Archive>
void describe(Problem& problem, Samples& samples, Archive& archive) {
  describe(static_cast<FrameProblem<float>&>(problem), archive);
  problem.fields(archive);
  archive.table(samples.y, problem.channels);
  archive.table(samples.weights, problem.channels);
  archive.table(samples.picture, problem.pixels());
  archive.number(samples.objective);
}

}  // namespace compueye::recon::core
