#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/running_sum_tables.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::OperatorKind;
using recon::Response;

namespace {

constexpr int picture_side = 40;

/// FNV-1a over the bits.
std::uint64_t fingerprint(const std::vector<float>& y, const std::vector<float>& x) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const auto* values : {&y, &x}) {
    for (const float v : *values) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &v, sizeof bits);
      for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ ((bits >> shift) & 0xFFU)) * 1099511628211ULL;
    }
  }
  return hash;
}

/// Rectangles with a grey rim and their seven images; integers over powers of two, so that every platform starts from
/// the same bits. `uneven` makes every entry another one.
Response rectangles(bool uneven) {
  std::vector<double> values;
  std::uint32_t state = 12345;
  for (int k = 0; k < 5; ++k) {
    for (int image = 0; image < 8; ++image) {
      for (int row = 0; row < picture_side; ++row) {
        for (int col = 0; col < picture_side; ++col) {
          int r = (image & 4) != 0 ? col : row, c = (image & 4) != 0 ? row : col;
          r = (image & 2) != 0 ? picture_side - 1 - r : r;
          c = (image & 1) != 0 ? picture_side - 1 - c : c;
          const int top = 3 * k + 1, left = 5 * k + 2, height = 11 + k, width = 17 - k;
          const bool in = r >= top && r < top + height && c >= left && c < left + width;
          const bool rim = in && (c == left || c == left + width - 1);
          state = state * 1664525U + 1013904223U;
          const double entry = uneven ? 0.5 + static_cast<double>(state >> 20) / 8192.0 : rim ? (k + 1) / 8.0 : 1.0;
          values.push_back(in ? entry : 0.0);
        }
      }
    }
  }
  return Response::from_dense(40, picture_side * picture_side, std::move(values))
      .value()
      .with_image(picture_side, picture_side)
      .value();
}

std::uint64_t golden(const recon::core::LinearOperator<float>& op) {
  std::vector<float> x, u, y(op.rows), back(op.cols, 0.0F);
  for (std::size_t n = 0; n < op.cols; ++n) x.push_back(static_cast<float>((n * 37) % 101) / 101.0F);
  for (std::size_t m = 0; m < op.rows; ++m) u.push_back(static_cast<float>((m * 53) % 97) / 97.0F - 0.25F);
  const recon::AlignedWorkspace memory(op.scratch_size() * sizeof(float) + 64);
  auto* scratch = reinterpret_cast<float*>(memory.span().data());
  recon::core::forward(op, x.data(), y.data(), scratch);
  recon::core::adjoint_accumulate(op, u.data(), back.data(), scratch);
  return fingerprint(y, back);
}

std::uint64_t golden_of(const Response& a, OperatorKind kind) {
  recon::KeptTables kept;
  return golden(recon::make_operator<float>(recon::quantised(a, kind), kind, kept).value());
}

std::uint64_t golden_sums(const Response& a, int rows_at_once) {
  recon::MirrorSymmetry images = recon::find_mirror_symmetry(a);
  REQUIRE(images.order() == 4);
  if (rows_at_once == 1) images = {{images.permutations.front()}, {{1}}};
  const auto transposed = rows_at_once == 8 ? recon::find_diagonal_symmetry(a) : std::vector<std::int32_t>{};
  const auto sums = recon::running_sum_tables<float>(a, images, transposed).value();
  CHECK(sums.view.rows_at_once == static_cast<std::size_t>(rows_at_once));
  recon::core::LinearOperator<float> op;
  op.kind = OperatorKind::running_sums;
  op.rows = static_cast<std::size_t>(a.rows());
  op.cols = static_cast<std::size_t>(a.cols());
  op.sums = sums.view;
  return golden(op);
}

}  // namespace

// As in golden_bits_test.cpp: the same on every build type, flag set and processor.
TEST_CASE("golden bits of operators") {
  const Response flat = rectangles(false), uneven = rectangles(true);
  CHECK(golden_sums(flat, 1) == 13866768438218927308ULL);
  CHECK(golden_sums(flat, 4) == 8879694915341144161ULL);
  CHECK(golden_sums(flat, 8) == 15725605924079593734ULL);
  CHECK(golden_of(uneven, OperatorKind::dense) == 9033668263411489382ULL);
  CHECK(golden_of(uneven, OperatorKind::csr) == 5682983639280031838ULL);
  CHECK(golden_of(uneven, OperatorKind::dense_runs) == 5766729431095455553ULL);
  CHECK(golden_of(uneven, OperatorKind::dense_runs_bf16) == 2544825961234364105ULL);
  CHECK(golden_of(uneven, OperatorKind::dense_runs_int8) == 15352324090456900888ULL);
  CHECK(golden_of(flat, OperatorKind::wavelet_runs) == 7933778644469218480ULL);
  CHECK(golden_of(uneven, OperatorKind::wavelet_runs) == 6945605175105901756ULL);
}
