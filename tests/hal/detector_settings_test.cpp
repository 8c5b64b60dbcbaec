#include "hal/detector_settings.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <optional>
#include <vector>

using namespace compueye::hal;

namespace {

struct Scan {
  int channels, each;
};

/// The lists that the header describes, written out.
std::vector<std::vector<int>> channels_by_converter(MuxOrder order, int channels, int each) {
  std::vector<std::vector<int>> converters(static_cast<std::size_t>(channels / each + (channels % each > 0 ? 1 : 0)));
  for (int m = 0; m < channels; ++m) {
    const std::size_t converter = order == MuxOrder::neighbours ? static_cast<std::size_t>(m / each)
                                                                : static_cast<std::size_t>(m) % converters.size();
    converters[converter].push_back(m);
  }
  return converters;
}

}  // namespace

TEST_CASE("each converter reads its channels in turn, in either order") {
  for (const MuxOrder order : {MuxOrder::neighbours, MuxOrder::interleaved}) {
    for (const Scan& scan :
         {Scan{64, 8}, Scan{64, 64}, Scan{6400, 80}, Scan{10, 4}, Scan{9, 4}, Scan{7, 2}, Scan{3, 3}}) {
      const int channels = scan.channels, each = scan.each;
      CAPTURE((order == MuxOrder::interleaved));
      CAPTURE(channels);
      CAPTURE(each);
      DetectorSettings detector;
      detector.mux_channels = each;
      detector.mux_order = order;
      int read = 0;
      for (const std::vector<int>& converter : channels_by_converter(order, channels, each)) {
        CHECK(static_cast<int>(converter.size()) <= each);
        std::optional<int> before;
        for (std::size_t k = 0; k < converter.size(); ++k, ++read) {
          CHECK(detector.slot(converter[k], channels) == static_cast<int>(k));
          CHECK(detector.turn(converter[k], channels) == doctest::Approx(static_cast<double>(k) / (each - 1)));
          CHECK(detector.read_before(converter[k], channels) == before);
          before = converter[k];
        }
      }
      CHECK(read == channels);
    }
  }
}

TEST_CASE("without a multiplexer every channel is read at once") {
  for (const int each : {0, 1}) {
    DetectorSettings detector;
    detector.mux_channels = each;
    detector.mux_order = MuxOrder::interleaved;
    for (const int m : {0, 1, 63}) {
      CHECK(detector.slot(m, 64) == 0);
      CHECK(detector.turn(m, 64) == 0.0);
      CHECK_FALSE(detector.read_before(m, 64).has_value());
    }
  }
}
