#include "recon/setup/parity_gram.hpp"

#include <cmath>

#include "recon/setup/on_all_cores.hpp"

namespace compueye::recon {

ParityGram::ParityGram(const Response& seeing, MetricKind metric)
    : gram_(seeing, metric), classes_(seeing.rows(), find_mirror_symmetry(seeing)) {
  for (std::size_t c = 0; c < classes_.count(); ++c) blocks_.emplace_back(classes_.order(c), classes_.order(c));
}

hal::Result<void> ParityGram::fill(const Progress& progress) {
  const auto& orbits = classes_.orbits();
  const bool made = on_all_cores(static_cast<int>(orbits.size()), "A A'", progress, [&, this] {
    return [&, this, scratch = gram_.make_scratch(),
            row = std::vector<double>(static_cast<std::size_t>(gram_.order()))](int orbit) mutable {
      gram_.row(orbits[static_cast<std::size_t>(orbit)].first, scratch, row);
      fill_row(orbit, row);
    };
  });
  if (made) return {};
  return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before A A' was finished");
}

/// Between unit vectors of two orbits p, q in class c: (|G| / (norm_p norm_q)) sum_g c(g) (A A')(p, g q).
void ParityGram::fill_row(int p, const std::vector<double>& row) {
  const MirrorSymmetry& symmetry = classes_.symmetry();
  const auto& orbits = classes_.orbits();
  const double group = static_cast<double>(symmetry.order());
  for (std::size_t c = 0; c < classes_.count(); ++c) {
    const int at = classes_.position(c, p);
    if (at < 0) continue;
    const double stabiliser_p = orbits[static_cast<std::size_t>(p)].stabiliser;
    for (std::size_t q = 0; q < orbits.size(); ++q) {
      const int to = classes_.position(c, static_cast<int>(q));
      if (to < 0) continue;
      double sum = 0.0;
      for (std::size_t g = 0; g < symmetry.order(); ++g) {
        const auto image = symmetry.permutations[g][static_cast<std::size_t>(orbits[q].first)];
        sum += symmetry.characters[c][g] * row[static_cast<std::size_t>(image)];
      }
      const double norms = std::sqrt(stabiliser_p * group) * std::sqrt(orbits[q].stabiliser * group);
      blocks_[c](to, at) = sum * group / norms;
    }
  }
}

}  // namespace compueye::recon
