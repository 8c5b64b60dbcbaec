#pragma once

#include <vector>

namespace compueye::recon {

/// Values of a core::DctTable for `length` >= 1, made in double and rounded once.
template <class T>
[[nodiscard]] std::vector<T> make_dct_table(int length);

}  // namespace compueye::recon
