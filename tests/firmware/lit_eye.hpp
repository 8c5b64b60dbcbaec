#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "calib/nominal.hpp"
#include "drivers/device/device_source.hpp"
#include "drivers/protocol/emulated_transport.hpp"
#include "firmware/eye/board.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// A device whose 16 channels see 8x8 pixels as the rows of a 4x4 eye say, with gains some percent apart, and are wired
/// in another order than its ommatidia. The pixels are lamps of its own, or whatever `light` says.
struct LitEye {
  static constexpr int channels = 16, pixels = 64, bits = 12;
  static constexpr double dark_lsb = 100.0, full_code = (1 << bits) - 1;
  static constexpr std::uint32_t longest_ns = 4'000'000;

  firmware::Board board = small_board();
  double lsb_per_pixel = 0.0;  ///< at the longest exposure
  double noise_lsb = 0.0;
  std::vector<double> rows;                  ///< by ommatidium
  std::function<double(std::size_t)> light;  ///< 0..1 of a pixel, now; empty: that of the lamps

  /// Of white, the brightest channel gives `full_scales` of its range at the longest exposure.
  explicit LitEye(double full_scales) {
    const recon::Response nominal = calib::nominal_response(board.eye, board.object).value();
    const std::vector<double> sums = nominal.row_sums();
    lsb_per_pixel = full_scales * full_code / *std::max_element(sums.begin(), sums.end());
    rows.assign(static_cast<std::size_t>(channels) * pixels, 0.0);
    for (int m = 0; m < channels; ++m) {
      const double gain = 1.0 + 0.01 * (m % 5 - 2);
      nominal.for_each_in_row(
          m, [&](std::int32_t n, double a) { rows[static_cast<std::size_t>(m * pixels + n)] = gain * a; });
    }
  }

  static int ommatidium(int channel) { return (5 * channel + 3) % channels; }

  static protocol::EmulatorSettings settings(const protocol::Bus& bus) {
    protocol::EmulatorSettings settings;
    settings.bus = &bus;
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
    for (int c = 0; c < channels; ++c) d.ommatidium_of_channel[static_cast<std::size_t>(c)] = ommatidium(c);
    return settings;
  }

  /// Without noise, at a share of the longest exposure.
  [[nodiscard]] double level_lsb(int m, std::span<const double> lit, double share) const {
    double sum = 0.0;
    for (std::size_t n = 0; n < pixels; ++n) sum += rows[static_cast<std::size_t>(m) * pixels + n] * lit[n];
    return dark_lsb + lsb_per_pixel * share * sum;
  }

  /// This outlives it.
  [[nodiscard]] protocol::SampleGenerator samples() {
    return [this](const protocol::EmulatedExposure& frame, std::span<std::int32_t> codes) {
      std::normal_distribution<double> noise(0.0, std::max(noise_lsb, std::numeric_limits<double>::min()));
      std::vector<double> lit(pixels);
      for (std::size_t n = 0; n < lit.size(); ++n) lit[n] = light ? light(n) : frame.levels[n] / 255.0;
      for (int c = 0; c < channels; ++c) {
        const double share = static_cast<double>(frame.exposure_ns) / longest_ns;
        const double level = level_lsb(ommatidium(c), lit, share) + noise(random_);
        codes[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(std::clamp(std::round(level), 0.0, full_code));
      }
    };
  }

 private:
  static firmware::Board small_board() {
    firmware::Board board = firmware::load_board(source_path("boards/generic-usb")).value();
    board.eye.rows = board.eye.columns = 4;
    board.object.rows = board.object.cols = 8;
    board.sensor.bits = bits;
    return board;
  }

  std::mt19937_64 random_{7};
};

/// It on a cable, on a clock of a test's choice.
struct LitDevice {
  const protocol::Bus& bus;
  hal::Clock& clock;
  protocol::DeviceEmulator device;

  /// All of them outlive it.
  LitDevice(LitEye& eye, const protocol::Bus& on, hal::Clock& time)
      : bus(on),
        clock(time),
        device(protocol::DeviceEmulator::create(LitEye::settings(bus), eye.samples(), clock.now_ns()).value()) {}

  /// As a program that has just been started finds it.
  [[nodiscard]] std::unique_ptr<device::DeviceSource> source() {
    device::DeviceSettings settings;
    settings.bus = &bus;
    settings.frame_rate_hz = 200.0;
    return device::DeviceSource::create(settings, std::make_unique<protocol::EmulatedTransport>(device, clock), clock)
        .value();
  }
};

}  // namespace compueye::test
