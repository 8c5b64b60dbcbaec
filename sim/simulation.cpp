#include "sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "hal/try.hpp"
#include "sim/plan/preview.hpp"
#include "sim/render/renderer.hpp"

namespace compueye::sim {
namespace {

/// Of one code step that integration may be off by.
constexpr double render_share_of_lsb = 0.05;

hal::Result<void> check(const EyeToSimulate& board) {
  TRY(board.eye.validate());
  TRY(board.object.validate());
  TRY(board.build.validate());
  TRY(board.sensor.validate());
  TRY(board.detector.validate(board.eye.ommatidia()));
  if (std::isfinite(board.frame_rate_hz) && board.frame_rate_hz > 0.0) return {};
  return hal::fail(hal::ErrorCode::out_of_range, "frame_rate_hz",
                   "is " + std::to_string(board.frame_rate_hz) + ", expected more than 0");
}

/// A scene that forces what there is not would be simulated without it in silence.
hal::Result<void> check_forced(const Scene& scene) {
  for (const auto& [effect, forced] : scene.effects) TRY(effect_named(effect));
  return {};
}

hal::Result<Plan> plan_of(const Circumstances& circumstances, const Planning& planning) {
  Plan plan = plan_effects(circumstances, Sensitivity::of_small_eye(), planning.budget);
  const bool measured =
      planning.budget.mode == PlanMode::automatic && planning.measure && plan.depends_on_sensitivity();
  if (!measured) return plan;
  const Sensitivity sensitivity = TRY(planning.measure(circumstances.scene));
  return plan_effects(circumstances, sensitivity, planning.budget);
}

Workings begin(const EyeToSimulate& board, const Scene& scene, std::uint64_t seed) {
  Workings workings;
  workings.seed = seed;
  workings.scene = lit(scene);
  workings.optics = OpticsAsBuilt::drawn(board.eye);
  workings.render.tolerance = render_share_of_lsb * board.sensor.lsb();
  return workings;
}

}  // namespace

struct Simulation::Parts {
  EyeToSimulate board;
  std::uint64_t seed = 0;
  Scene scene;
  Preview preview;
  Plan plan;
  Workings workings;
  std::optional<Renderer> renderer;  // made once the scene has its place
  std::vector<double> signals, render, levels;
  std::vector<std::int32_t> stuck;
  std::vector<double> channel_turn;      // 0 .. 1 of the scan, by channel
  bool changes = false;                  // the scene, as far as it is rendered
  std::optional<std::uint64_t> exposed;  // the frame that signals are of
  RenderWatch watch;

  /// What the planned effects make of the scene as it is.
  hal::Result<void> prepare() {
    const Circumstances circumstances{board, scene, preview};
    workings = begin(board, scene, seed);
    for (const PlannedEffect& each : plan.effects) {
      if (each.on()) each.effect->apply(circumstances, workings);
    }
    changes = workings.render.motion && !workings.scene.still();
    renderer = TRY(Renderer::create(board.eye, board.object, workings.optics, workings.render, workings.scene));
    exposed.reset();
    return {};
  }

  [[nodiscard]] double start_s(std::uint64_t frame) const noexcept {
    return static_cast<double>(frame) * board.period_s();
  }
  /// The scene begins anew after its duration; lamps and sensors do not.
  [[nodiscard]] double scene_s(std::uint64_t frame) const noexcept { return scene.own_time_s(start_s(frame)); }

  /// signals = the mean over the instants of the integration, which begins at `t_s`; part `part` of `parts` of a frame.
  [[nodiscard]] bool integrate(double t_s, std::span<double> into, int part, int parts) {
    const int n = workings.exposure.instants;
    std::fill(into.begin(), into.end(), 0.0);
    for (int k = 0; k < n; ++k) {
      const auto told = [&](double share) { return watch("rendering", (part + (k + share) / n) / parts); };
      const Renderer::Watch each = watch ? Renderer::Watch(told) : Renderer::Watch();
      if (!renderer->render(t_s + (k + 0.5) / n * board.integration_s(), render, each)) return false;
      for (std::size_t m = 0; m < into.size(); ++m) into[m] += render[m] / n;
    }
    return true;
  }

  /// Channels at their own times: linear between the times of the scan that are rendered.
  [[nodiscard]] bool integrate_in_turn(double t_s) {
    const int n = workings.exposure.scan_instants;
    std::fill(signals.begin(), signals.end(), 0.0);
    for (int k = 0; k < n; ++k) {
      if (!integrate(t_s + board.detector.scan_s() * k / (n - 1), levels, k, n)) return false;
      for (std::size_t m = 0; m < signals.size(); ++m) {
        signals[m] += std::max(0.0, 1.0 - std::fabs(channel_turn[m] * (n - 1) - k)) * levels[m];
      }
    }
    return true;
  }

  hal::Result<void> expose(std::uint64_t frame) {
    if (exposed && (!changes || *exposed == frame)) return {};
    exposed.reset();
    const double t_s = scene_s(frame);
    const bool done = workings.exposure.channels_in_turn ? integrate_in_turn(t_s) : integrate(t_s, signals, 0, 1);
    if (!done) return hal::fail(hal::ErrorCode::interrupted, scene.name, "its rendering was stopped");
    exposed = frame;
    return {};
  }

  /// levels = what the converter is given.
  void detect(std::span<const double> of, std::uint64_t frame) noexcept {
    const double lsb = board.sensor.lsb();
    for (std::size_t m = 0; m < levels.size(); ++m) levels[m] = of[m] / lsb;
    std::fill(stuck.begin(), stuck.end(), -1);
    FrameInWork work{frame, start_s(frame), levels, stuck};
    for (const auto& step : workings.steps) step->apply(work);
    for (std::size_t m = 0; m < levels.size(); ++m) {
      if (stuck[m] >= 0) levels[m] = std::min(stuck[m], board.sensor.largest_code());
    }
  }

  /// True when at least one channel reaches the largest code.
  [[nodiscard]] bool convert(std::span<std::int32_t> codes) const noexcept {
    const std::int32_t largest = board.sensor.largest_code();
    bool saturated = false;
    for (std::size_t m = 0; m < codes.size(); ++m) {
      codes[m] = static_cast<std::int32_t>(std::clamp(std::round(levels[m]), 0.0, static_cast<double>(largest)));
      saturated = saturated || codes[m] == largest;
    }
    return saturated;
  }
};

Simulation::Simulation(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

hal::Result<Simulation> Simulation::create(EyeToSimulate board, Scene scene, std::uint64_t seed,
                                           const Planning& planning) {
  TRY(check(board));
  TRY(validate(scene));
  TRY(check_forced(scene));
  auto parts = std::make_unique<Parts>();
  Parts& p = *parts;
  p.board = std::move(board);
  p.scene = std::move(scene);
  p.watch = planning.watch;
  p.preview = TRY(preview_of(p.board, p.scene, p.watch));
  p.seed = seed;
  p.plan = TRY(plan_of({p.board, p.scene, p.preview}, planning));
  TRY(p.prepare());
  const auto channels = static_cast<std::size_t>(p.board.eye.ommatidia());
  for (auto* each : {&p.signals, &p.render, &p.levels, &p.channel_turn}) each->resize(channels);
  p.stuck.resize(channels);
  for (std::size_t m = 0; m < channels; ++m) {
    p.channel_turn[m] = p.board.detector.turn(static_cast<int>(m), p.board.eye.ommatidia());
  }
  TRY(p.expose(0));
  p.watch = nullptr;  // may look at what its caller owns
  return Simulation(std::move(parts));
}

hal::Result<void> Simulation::show(hal::Image picture) {
  Scene& scene = parts_->scene;
  if (scene.surfaces.front().bands.size() != 1) {
    return hal::fail(hal::ErrorCode::mismatch, scene.name,
                     "shows a picture of " + std::to_string(scene.surfaces.front().bands.size()) +
                         " bands, expected one: a grey display");
  }
  std::swap(scene.surfaces.front().bands.front(), picture);
  const auto made = validate(scene).and_then([&] { return parts_->prepare(); });
  if (!made) std::swap(scene.surfaces.front().bands.front(), picture);
  return made;
}

const Plan& Simulation::plan() const noexcept {
  return parts_->plan;
}
const EyeToSimulate& Simulation::board() const noexcept {
  return parts_->board;
}

std::span<const double> Simulation::noise_free(std::uint64_t frame) {
  (void)parts_->expose(frame);
  return parts_->signals;
}

std::span<const double> Simulation::levels_lsb(std::uint64_t frame) {
  (void)parts_->expose(frame);
  parts_->detect(parts_->signals, frame);
  return parts_->levels;
}

void Simulation::watch(RenderWatch watch) {
  parts_->watch = std::move(watch);
}

hal::Result<bool> Simulation::codes(std::uint64_t frame, std::span<std::int32_t> codes) {
  TRY(parts_->expose(frame));
  return codes_of(parts_->signals, frame, codes);
}

bool Simulation::codes_of(std::span<const double> signals, std::uint64_t frame, std::span<std::int32_t> codes) {
  parts_->detect(signals, frame);
  return parts_->convert(codes);
}

}  // namespace compueye::sim
