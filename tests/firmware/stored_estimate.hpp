#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/eye/board.hpp"

namespace compueye::test {

/// Of a board's eye, all of whose channels are good.
inline calib::Estimate good_estimate(const firmware::Board& board) {
  calib::Estimate estimate;
  estimate.made_unix_s = 1796000100;
  estimate.program = "0.1.0";
  estimate.method = "by hand";
  estimate.distance_mm = board.object.distance_mm;
  estimate.status.assign(static_cast<std::size_t>(board.eye.ommatidia()), hal::ChannelStatus::good);
  return estimate;
}

/// As the newest estimate of the board's eye; makes the file where there is none. Its number.
inline std::int64_t store_estimate(const std::filesystem::path& path, const firmware::Board& board,
                                   const calib::Estimate& estimate, const recon::Response& response,
                                   std::span<const float> sigma = {}) {
  auto file = std::filesystem::exists(path)
                  ? calib::EyeFile::open(path, calib::EyeFileMode::write)
                  : calib::EyeFile::create(path, {board.source.serial, board.eye, board.object});
  REQUIRE_MESSAGE(file.has_value(), file.error().text());
  const auto id = file->store_estimate(estimate, response, sigma);
  REQUIRE_MESSAGE(id.has_value(), id.error().text());
  REQUIRE(file->close().has_value());
  return *id;
}

}  // namespace compueye::test
