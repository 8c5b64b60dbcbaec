#include "recon/setup/parity_classes.hpp"

#include <cmath>
#include <utility>

namespace compueye::recon {

ParityClasses::ParityClasses(int rows, MirrorSymmetry symmetry) : symmetry_(std::move(symmetry)) {
  find_orbits(rows);
  find_positions();
}

double ParityClasses::share(std::size_t c, int m) const noexcept {
  const Place place = places_[static_cast<std::size_t>(m)];
  const int sign = symmetry_.characters[c][static_cast<std::size_t>(place.element)];
  return sign * orbits_[static_cast<std::size_t>(place.orbit)].component;
}

void ParityClasses::find_orbits(int rows) {
  places_.assign(static_cast<std::size_t>(rows), {-1, 0});
  for (int m = 0; m < rows; ++m) {
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
void ParityClasses::find_positions() {
  for (const std::vector<int>& signs : symmetry_.characters) {
    std::vector<int> positions;
    int size = 0;
    for (const Orbit& orbit : orbits_) {
      bool present = true;
      for (std::size_t g = 0; g < symmetry_.order(); ++g) {
        const bool fixed = symmetry_.permutations[g][static_cast<std::size_t>(orbit.first)] == orbit.first;
        present = present && (!fixed || signs[g] == 1);
      }
      positions.push_back(present ? size++ : -1);
    }
    positions_.push_back(std::move(positions));
    orders_.push_back(size);
  }
}

}  // namespace compueye::recon
