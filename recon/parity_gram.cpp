#include "recon/parity_gram.hpp"

#include <cmath>
#include <utility>

#include "recon/on_all_cores.hpp"

namespace compueye::recon {

ParityGram::ParityGram(const Response& seeing, int image_rows, int image_cols, MetricKind metric)
    : gram_(seeing, image_rows, image_cols, metric), symmetry_(find_mirror_symmetry(seeing, image_rows, image_cols)) {
  find_orbits();
  find_blocks();
}

hal::Result<void> ParityGram::fill(const Progress& progress) {
  const bool made = on_all_cores(static_cast<int>(orbits_.size()), "A A'", progress, [this] {
    return [this, scratch = gram_.make_scratch(),
            row = std::vector<double>(static_cast<std::size_t>(gram_.order()))](int orbit) mutable {
      gram_.row(orbits_[static_cast<std::size_t>(orbit)].first, scratch, row);
      fill_row(orbit, row);
    };
  });
  if (made) return {};
  return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before A A' was finished");
}

double ParityGram::share(std::size_t c, int m) const noexcept {
  const Place place = places_[static_cast<std::size_t>(m)];
  const int sign = symmetry_.characters[c][static_cast<std::size_t>(place.element)];
  return sign * orbits_[static_cast<std::size_t>(place.orbit)].component;
}

void ParityGram::find_orbits() {
  places_.assign(static_cast<std::size_t>(gram_.order()), {-1, 0});
  for (int m = 0; m < gram_.order(); ++m) {
    if (places_[static_cast<std::size_t>(m)].orbit >= 0) continue;
    Orbit orbit{m, 0, 0.0};
    for (std::size_t g = 0; g < symmetry_.order(); ++g) {
      const auto image = static_cast<std::size_t>(symmetry_.permutations[g][static_cast<std::size_t>(m)]);
      if (image == static_cast<std::size_t>(m)) ++orbit.stabiliser;
      if (places_[image].orbit < 0) places_[image] = {static_cast<int>(orbits_.size()), static_cast<int>(g)};
    }
    orbit.component = std::sqrt(orbit.stabiliser / static_cast<double>(symmetry_.order()));
    orbits_.push_back(orbit);
  }
}

/// A class has a component on an orbit only when its sign is +1 on everything that leaves the orbit's row in place.
void ParityGram::find_blocks() {
  for (const std::vector<int>& signs : symmetry_.characters) {
    Block block;
    int size = 0;
    for (const Orbit& orbit : orbits_) {
      bool present = true;
      for (std::size_t g = 0; g < symmetry_.order(); ++g) {
        const bool fixed = symmetry_.permutations[g][static_cast<std::size_t>(orbit.first)] == orbit.first;
        present = present && (!fixed || signs[g] == 1);
      }
      block.position.push_back(present ? size++ : -1);
    }
    block.matrix.resize(size, size);
    blocks_.push_back(std::move(block));
  }
}

/// Between unit vectors of two orbits p, q in class c: (|G| / (norm_p norm_q)) sum_g c(g) (A A')(p, g q).
void ParityGram::fill_row(int p, const std::vector<double>& row) {
  const double group = static_cast<double>(symmetry_.order());
  for (std::size_t c = 0; c < blocks_.size(); ++c) {
    Block& block = blocks_[c];
    const int at = block.position[static_cast<std::size_t>(p)];
    if (at < 0) continue;
    const double stabiliser_p = orbits_[static_cast<std::size_t>(p)].stabiliser;
    for (std::size_t q = 0; q < orbits_.size(); ++q) {
      const int to = block.position[q];
      if (to < 0) continue;
      double sum = 0.0;
      for (std::size_t g = 0; g < symmetry_.order(); ++g) {
        const auto image = symmetry_.permutations[g][static_cast<std::size_t>(orbits_[q].first)];
        sum += symmetry_.characters[c][g] * row[static_cast<std::size_t>(image)];
      }
      const double norms = std::sqrt(stabiliser_p * group) * std::sqrt(orbits_[q].stabiliser * group);
      block.matrix(to, at) = sum * group / norms;
    }
  }
}

}  // namespace compueye::recon
