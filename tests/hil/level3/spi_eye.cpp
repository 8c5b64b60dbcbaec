// The emulated converters of a board, in front of a scene, on device files of this machine's own kernel. Their chip
// selects are what the kernel drives its lines to; their data-ready edges are bytes that go to a file, behind which
// somebody drives the line.

#include <fcntl.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include "firmware/eye/board_wiring.hpp"
#include "hal/try.hpp"
#include "tests/hil/converters_in_time.hpp"
#include "tests/hil/level3/board_in_scene.hpp"
#include "tests/hil/level3/cuse_spidev.hpp"
#include "tests/hil/level3/driven_lines.hpp"

namespace compueye::hil {
namespace {

std::string device_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

std::string driven_now() {
  std::ifstream file("/sys/kernel/debug/gpio");
  return {std::istreambuf_iterator<char>(file), {}};
}

hal::Result<frontend::EmulatedFrontEndSettings> converters_of(const BoardInScene& eye) {
  frontend::EmulatedFrontEndSettings settings;
  settings.chip = frontend::find_front_end(eye.board.wiring.chip);
  if (settings.chip == nullptr) {
    return hal::fail(hal::ErrorCode::usage, eye.board.name, "has no converters; expected a board of kind spi");
  }
  settings.front_end = TRY(firmware::front_end_settings(eye.board));
  settings.samples = [seen = eye.simulation](std::uint64_t index, std::span<std::int32_t> codes) {
    static_cast<void>(seen->codes(index, codes));
  };
  return settings;
}

hal::Result<void> serve(const std::string& folder, const std::string& scene, const std::string& edges) {
  const BoardInScene eye = TRY(board_in_scene(folder, scene));
  const firmware::WiringSettings& wiring = eye.board.wiring;
  const int line = edges.empty() ? -1 : ::open(edges.c_str(), O_WRONLY | O_CLOEXEC);
  if (!edges.empty() && line < 0) return hal::fail(hal::ErrorCode::io, edges, "cannot be opened for edges");
  ConvertersInTime converters(TRY(converters_of(eye)), [line](std::int64_t) {
    if (line >= 0 && ::write(line, "\n", 1) != 1) std::cerr << "spi_eye: an edge did not get out\n";
  });
  if (const auto select = firmware::line_names(wiring.select)) {
    converters.before_exchange = [&converters, select] {
      converters.select(driven_number(driven_now(), select->chip, select->lines));
    };
  }
  const auto data = TRY(CuseSpidev::create(device_name(wiring.data), converters.data()));
  std::unique_ptr<CuseSpidev> settings;
  std::thread of_settings;
  if (!wiring.settings.empty()) {
    settings = TRY(CuseSpidev::create(device_name(wiring.settings), converters.settings()));
    of_settings = std::thread([&settings] { settings->serve(); });
  }
  data->serve();
  if (of_settings.joinable()) of_settings.join();
  return {};
}

}  // namespace
}  // namespace compueye::hil

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::cerr << "usage: spi_eye BOARD SCENE [EDGES]\n";
    return 2;
  }
  const auto served = compueye::hil::serve(argv[1], argv[2], argc > 3 ? argv[3] : "");
  if (!served) std::cerr << "spi_eye: " << served.error().text() << "\n";
  return served ? 0 : 1;
}
