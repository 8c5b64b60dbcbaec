#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "calib/nominal.hpp"
#include "drivers/device/device_source.hpp"
#include "drivers/protocol/emulated_transport.hpp"
#include "firmware/eye/board.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// An emulated device with a lamp a pixel, of which its channels see what the rows of a 4x4 eye say, with gains some
/// percent apart, wired in another order than its ommatidia. Virtual time.
class LitEye {
 public:
  static constexpr int channels = 16, pixels = 64, bits = 12;
  static constexpr double dark_lsb = 100.0;

  /// Of white, the brightest channel gives `full_scales` of its range at the longest exposure.
  LitEye(const protocol::Bus& bus, double full_scales, double noise_lsb)
      : board(small_board()), noise_lsb_(noise_lsb), bus_(&bus) {
    const recon::Response nominal = calib::nominal_response(board.eye, board.object).value();
    const std::vector<double> sums = nominal.row_sums();
    const double brightest = *std::max_element(sums.begin(), sums.end());
    lsb_per_pixel = full_scales * full_code / brightest;
    rows.assign(static_cast<std::size_t>(channels) * pixels, 0.0);
    for (int m = 0; m < channels; ++m) {
      const double gain = 1.0 + 0.01 * (m % 5 - 2);
      nominal.for_each_in_row(
          m, [&](std::int32_t n, double a) { rows[static_cast<std::size_t>(m * pixels + n)] = gain * a; });
    }
    protocol::EmulatorSettings settings;
    settings.bus = bus_;
    auto& d = settings.descriptor = protocol::tests::descriptor_of(channels, bits);
    d.serial = "CE-LIT";
    d.least_frame_rate_mhz = 1000;
    d.most_frame_rate_mhz = 1'000'000;
    d.least_exposure_ns = 10'000;
    d.most_exposure_ns = longest_ns;
    d.illuminators.clear();
    for (std::uint8_t n = 0; n < pixels; ++n) {
      d.illuminators.push_back({n, protocol::IlluminatorKind::lamp, 256, 1, 1, 3'000'000});
    }
    for (int c = 0; c < channels; ++c) d.ommatidium_of_channel[static_cast<std::size_t>(c)] = (5 * c + 3) % channels;
    device = std::make_unique<protocol::DeviceEmulator>(
        protocol::DeviceEmulator::create(
            settings, [this](const auto& frame, auto codes) { see(frame, codes); }, clock.now_ns())
            .value());
  }

  /// As a program that has just been started finds it.
  [[nodiscard]] std::unique_ptr<device::DeviceSource> source() {
    device::DeviceSettings settings;
    settings.bus = bus_;
    settings.frame_rate_hz = 200.0;
    return device::DeviceSource::create(settings, std::make_unique<protocol::EmulatedTransport>(*device, clock), clock)
        .value();
  }

  static constexpr std::uint32_t longest_ns = 4'000'000;
  static constexpr double full_code = (1 << bits) - 1;

  firmware::Board board;
  hal::VirtualClock clock{1'000'000'000};
  double lsb_per_pixel = 0.0;  ///< at the longest exposure
  std::vector<double> rows;    ///< by ommatidium
  std::unique_ptr<protocol::DeviceEmulator> device;

 private:
  static firmware::Board small_board() {
    firmware::Board board = firmware::load_board(source_path("boards/generic-usb")).value();
    board.eye.rows = board.eye.columns = 4;
    board.object.rows = board.object.cols = 8;
    board.sensor.bits = bits;
    return board;
  }

  void see(const protocol::EmulatedExposure& frame, std::span<std::int32_t> codes) {
    const double share = static_cast<double>(frame.exposure_ns) / longest_ns;
    std::normal_distribution<double> noise(0.0, std::max(noise_lsb_, std::numeric_limits<double>::min()));
    for (std::size_t c = 0; c < codes.size(); ++c) {
      const auto m = static_cast<std::size_t>(device->descriptor().ommatidium_of_channel[c]);
      double light = 0.0;
      for (std::size_t n = 0; n < pixels; ++n) light += rows[m * pixels + n] * frame.levels[n] / 255.0;
      const double level = dark_lsb + lsb_per_pixel * share * light + noise(random_);
      codes[c] = static_cast<std::int32_t>(std::clamp(std::round(level), 0.0, full_code));
    }
  }

  double noise_lsb_;
  const protocol::Bus* bus_;
  std::mt19937_64 random_{7};
};

}  // namespace compueye::test
