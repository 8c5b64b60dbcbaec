#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "recon/core/frame/frozen_frame.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {

/// Lays out what core::describe() names as core::FrozenReader takes it.
class FrozenWriter {
 public:
  void bits(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<std::byte>(value >> shift));
  }

  template <class Number>
  void number(Number value) {
    if constexpr (std::is_floating_point_v<Number>) {
      bits(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
    } else {
      bits(static_cast<std::uint64_t>(value));
    }
  }
  template <class Kind>
  void kind(Kind value) {
    bits(static_cast<std::uint64_t>(value));
  }

  template <class N>
  void table(const N* values, std::size_t count) {
    static_assert(std::endian::native == std::endian::little);
    bits(values == nullptr ? 0 : count);
    if (values == nullptr || count == 0) return;
    bytes_.resize((bytes_.size() + core::frozen_alignment - 1) / core::frozen_alignment * core::frozen_alignment);
    const auto start = bytes_.size();
    bytes_.resize(start + count * sizeof(N));
    std::memcpy(bytes_.data() + start, values, count * sizeof(N));
  }

  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// The bytes that core::thaw() reads: every number and table of the frame, wherever its pointers lead.
template <class Problem>
[[nodiscard]] std::vector<std::byte> freeze_problem(const core::FrameProblem<float>& shared,
                                                    core::FrozenSamples samples) {
  auto problem = static_cast<const Problem&>(shared);  // a copy: an archive may read or write
  FrozenWriter writer;
  writer.bits(core::frozen_magic);
  writer.bits(core::frozen_version);
  writer.bits(0);  // the size, when it is known
  for (std::size_t word = 0; word < core::frozen_name_words; ++word) {
    writer.bits(core::frozen_name_word(Problem::method, word));
  }
  core::describe(problem, samples, writer);
  std::vector<std::byte> bytes = writer.take();
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 2 * sizeof size, &size, sizeof size);
  return bytes;
}

/// A row with the traits of `row`, of the method whose problem is Problem<T> and is made by `Method::prepare<T>`.
template <template <class> class Problem, class Method>
[[nodiscard]] constexpr SolverRow solver_row_of(SolverRow row) {
  row.name = Problem<float>::method;
  row.f32 = {&Problem<float>::solver, &Method::template prepare<float>};
  row.f64 = {&Problem<double>::solver, &Method::template prepare<double>};
  row.freeze = &freeze_problem<Problem<float>>;
  return row;
}

}  // namespace compueye::recon
