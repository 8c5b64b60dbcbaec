#include "firmware/eye/living_response.hpp"

#include <utility>

#include "calib/nominal.hpp"

namespace compueye::firmware {

hal::Result<LivingResponse> living_response(const Board& board, const recon::Progress& progress) {
  auto response = calib::nominal_response(board.eye, board.object, progress);
  if (!response) return tl::unexpected(std::move(response.error()));
  std::vector<std::uint8_t> sees(static_cast<std::size_t>(response->rows()), 0);
  for (const std::int32_t m : response->seeing_rows()) sees[static_cast<std::size_t>(m)] = 1;
  if (!board.sensor.dead.empty()) response = response->without_rows(board.sensor.dead);
  return LivingResponse{std::move(*response), std::move(sees)};
}

}  // namespace compueye::firmware
