#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "recon/core/parts/workspace.hpp"

namespace compueye::recon {

/// Memory aligned as the frame path wants its workspace (core::Workspace::alignment), of exactly the size asked for and
/// not initialised. Throws std::bad_alloc.
class AlignedWorkspace {
 public:
  explicit AlignedWorkspace(std::size_t bytes)
      : bytes_(bytes), memory_(static_cast<std::byte*>(::operator new(bytes, alignment))) {}

  [[nodiscard]] std::span<std::byte> span() const noexcept { return {memory_.get(), bytes_}; }

 private:
  static constexpr std::align_val_t alignment{core::Workspace::alignment};
  struct Release {
    void operator()(std::byte* memory) const noexcept { ::operator delete(memory, alignment); }
  };

  std::size_t bytes_;
  std::unique_ptr<std::byte, Release> memory_;
};

}  // namespace compueye::recon
