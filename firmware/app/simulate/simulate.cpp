#include "firmware/app/simulate/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "firmware/app/report/json_report.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "sim/scene_truth.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

Result<void> check(const SimulateOptions& o) {
  const auto need = [](bool ok, const char* option, const std::string& sentence) -> Result<void> {
    if (ok) return {};
    return hal::fail(ErrorCode::usage, option, sentence);
  };
  const auto length = [&](const char* option, const std::optional<double>& mm) {
    const bool ok = !mm || (std::isfinite(*mm) && *mm > 0.0 && *mm <= 1e6);
    return need(ok, option, "is " + std::to_string(mm.value_or(0.0)) + ", expected mm above 0 and at most 1000000");
  };
  return need(o.frames >= 1 && o.frames <= 1'000'000, "--frames",
              "is " + std::to_string(o.frames) + ", expected 1 to 1000000")
      .and_then([&] { return need(o.seed >= 0, "--seed", "is negative, expected 0 or more"); })
      .and_then([&] { return need(o.scene_seed >= 0, "--scene-seed", "is negative, expected 0 or more"); })
      .and_then([&] { return length("--distance", o.distance_mm); })
      .and_then([&] { return length("--scene-distance", o.scene_distance_mm); })
      .and_then([&] {
        const bool anything = !o.out.empty() || !o.truth.empty() || o.explain;
        return need(anything, "--out", "is missing: name the .npy file for the samples, for example --out y.npy");
      });
}

struct Effect {
  std::string name;
  bool on = false;
  std::string what;
};

std::vector<Effect> effects_of(const Board& board, const sim::Scene& scene, const SimulateOptions& o) {
  const SensorSettings& s = board.sensor;
  const bool sensor = !o.noise_free || o.codes;
  const bool away = scene.distance_mm && *scene.distance_mm != board.object.distance_mm;
  return {
      {"acceptance cone", true, "flat top, light integrated below pixel size"},
      {"scene off the object plane", away,
       away ? significant(*scene.distance_mm, 4) + " mm instead of " + significant(board.object.distance_mm, 4) : ""},
      {"dark level", sensor && s.dark_level_lsb > 0.0,
       significant(s.dark_level_lsb, 4) + " LSB" + (o.codes ? "" : ", taken out again")},
      {"read noise", !o.noise_free && s.read_noise_lsb > 0.0, significant(s.read_noise_lsb, 4) + " LSB"},
      {"quantisation", sensor, fmt::format("{} bits, one LSB is {} of a white pixel", s.bits, significant(s.lsb(), 4))},
      {"dead channels", !s.dead.empty(), fmt::format("{}", s.dead.size())},
      {"lost frames", false, ""},
  };
}

std::string table_of(const std::vector<Effect>& effects) {
  Table table({{"effect", Align::left}, {"", Align::left}, {"", Align::left}});
  for (const Effect& effect : effects) table.add({effect.name, effect.on ? "on" : "off", effect.on ? effect.what : ""});
  return table.text();
}

/// All frames after each other, M values each.
struct Samples {
  std::vector<float> values;
  std::vector<float> weights;
  std::uint64_t saturated_frames = 0;
};

void append(const hal::SampleBlock& block, const Board& board, bool codes, Samples& samples) {
  const double lsb = board.sensor.lsb(), dark = board.sensor.dark_level_lsb;
  for (std::size_t c = 0; c < block.codes.size(); ++c) {
    const bool valid = block.valid[c] != 0;
    const double code = block.codes[c];
    const double value = codes ? code : (code - dark) * lsb;
    samples.values.push_back(valid ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN());
    samples.weights.push_back(valid ? 1.0F : 0.0F);
  }
  if (block.flags.saturated) ++samples.saturated_frames;
}

Result<Samples> take(const Board& board, const sim::Scene& scene, const SimulateOptions& o) {
  hal::VirtualClock clock;
  auto settings = simulated_eye_settings(board, scene, static_cast<std::uint64_t>(o.seed));
  if (o.noise_free) settings.steps_off.emplace_back("read noise");
  auto eye = sim::SimulatedEye::create(std::move(settings), clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  if (auto started = (*eye)->start(); !started) return tl::unexpected(std::move(started.error()));
  const std::span<const double> signal = (*eye)->noise_free(0);
  Samples samples;
  for (std::int64_t f = 0; f < o.frames; ++f) {
    const auto block = (*eye)->read(0);
    if (!block) return tl::unexpected(block.error());
    append(*block, board, o.codes, samples);
    if (!o.noise_free || o.codes) continue;
    for (std::size_t c = 0; c < signal.size(); ++c) {
      float& value = samples.values[samples.values.size() - signal.size() + c];
      if (!std::isnan(value)) value = static_cast<float>(signal[c]);
    }
  }
  return samples;
}

Result<void> write(const Samples& samples, const Board& board, const SimulateOptions& o) {
  std::vector<std::int64_t> shape{board.eye.ommatidia()};
  if (o.frames > 1) shape.insert(shape.begin(), o.frames);
  if (!o.out.empty()) {
    if (auto written = write_npy(o.out, shape, std::span<const float>(samples.values)); !written) return written;
  }
  if (o.weights.empty()) return {};
  return write_npy(o.weights, shape, std::span<const float>(samples.weights));
}

Result<void> write_truth(const Board& board, const sim::Scene& scene, const SimulateOptions& o) {
  if (o.truth.empty()) return {};
  return sim::scene_truth(scene, board.object).and_then([&](const hal::Image& truth) {
    const std::array<std::int64_t, 2> shape{truth.rows, truth.cols};
    return write_npy(o.truth, shape, std::span<const float>(truth.pixels));
  });
}

Json json_of(const Board& board, const sim::Scene& scene, const Samples& samples, const SimulateOptions& o) {
  Json effects = Json::array();
  for (const Effect& e : effects_of(board, scene, o))
    effects.push_back({{"name", e.name}, {"on", e.on}, {"what", e.what}});
  return {{"board", board.name},
          {"scene", scene.name},
          {"frames", o.frames},
          {"channels", board.eye.ommatidia()},
          {"seed", o.seed},
          {"distance_mm", board.object.distance_mm},
          {"unit", o.codes ? "code" : "fully seen white pixel"},
          {"lsb", board.sensor.lsb()},
          {"noise_sigma", o.noise_free ? 0.0 : board.sensor.noise_sigma()},
          {"dead_channels", board.sensor.dead.size()},
          {"saturated_frames", samples.saturated_frames},
          {"effects", std::move(effects)},
          {"samples_file", o.out.string()},
          {"truth_file", o.truth.string()}};
}

Result<void> report(const Board& board, const sim::Scene& scene, const Samples& samples, const SimulateOptions& o) {
  if (o.json) return print_text(json_text(json_of(board, scene, samples, o)));
  std::string text;
  if (o.explain) text += table_of(effects_of(board, scene, o));
  if (!o.out.empty()) {
    text += fmt::format("{}: {} frame{} of {} samples of {} in front of {}\n", o.out.string(), o.frames,
                        o.frames == 1 ? "" : "s", board.eye.ommatidia(), board.name, scene.name);
  }
  if (samples.saturated_frames > 0)
    text += fmt::format("{} frames have saturated channels\n", samples.saturated_frames);
  if (!board.sensor.dead.empty()) {
    text += fmt::format("{} dead channels are NaN; --weights writes the weights that leave them out\n",
                        board.sensor.dead.size());
  }
  return print_text(text);
}

}  // namespace

Result<void> simulate(const SimulateOptions& options) {
  if (auto checked = check(options); !checked) return checked;
  auto board = load_board(options.board);
  if (!board) return tl::unexpected(std::move(board.error()));
  if (options.distance_mm) board->object.distance_mm = *options.distance_mm;
  const auto scene =
      choose_scene(*board, {options.scene, static_cast<std::uint64_t>(options.scene_seed), options.scene_distance_mm});
  if (!scene) return tl::unexpected(scene.error());
  const auto samples = take(*board, *scene, options);
  if (!samples) return tl::unexpected(samples.error());
  return write(*samples, *board, options).and_then([&] { return write_truth(*board, *scene, options); }).and_then([&] {
    return report(*board, *scene, *samples, options);
  });
}

}  // namespace compueye::firmware
