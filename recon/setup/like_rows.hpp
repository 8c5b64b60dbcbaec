#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace compueye::recon {

/// Rows in groups of `together` that share what they consist of: `parts` of each row, numbers ascending, of `all`. A
/// group is a first row, the lowest that is left, with those of the next couple of hundred that leave it the fewest
/// parts which not every row has; the last group may be short. All rows in the order of their groups.
[[nodiscard]] std::vector<std::int32_t> in_groups_of_like_rows(const std::vector<std::vector<std::uint16_t>>& parts,
                                                               std::size_t all, std::size_t together);

}  // namespace compueye::recon
