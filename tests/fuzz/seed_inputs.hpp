#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace compueye::fuzz {

/// Inputs to begin with: right ones of each kind, small, and the same every time.
[[nodiscard]] std::vector<std::vector<std::byte>> packet_stream_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> descriptor_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> hid_report_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> cobs_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> recording_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> board_file_seeds();
[[nodiscard]] std::vector<std::vector<std::byte>> reconstruct_seeds();

}  // namespace compueye::fuzz
