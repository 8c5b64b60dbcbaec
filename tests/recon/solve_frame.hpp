#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

#include "recon/reconstructor.hpp"

namespace compueye::tests {

/// 64-byte aligned memory of exactly the size asked for.
class AlignedBytes {
 public:
  explicit AlignedBytes(std::size_t size)
      : size_(size), bytes_(static_cast<std::byte*>(::operator new (size, std::align_val_t{64}))) {}
  AlignedBytes(const AlignedBytes&) = delete;
  AlignedBytes& operator=(const AlignedBytes&) = delete;
  ~AlignedBytes() { ::operator delete (bytes_, std::align_val_t{64}); }
  [[nodiscard]] std::span<std::byte> span() const { return {bytes_, size_}; }

 private:
  std::size_t size_;
  std::byte* bytes_;
};

struct SolvedFrame {
  recon::FrameInfo info;
  std::vector<float> x;
};

inline SolvedFrame solve_frame(const recon::Reconstructor& solver, const std::vector<float>& y,
                               const std::vector<float>& weights = {}) {
  const AlignedBytes workspace(solver.required_bytes());
  SolvedFrame frame;
  frame.x.resize(static_cast<std::size_t>(solver.pixels()));
  frame.info = solver.solve(y, weights, workspace.span(), frame.x);
  return frame;
}

}  // namespace compueye::tests
