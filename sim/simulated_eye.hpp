#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/clock.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/sample_source.hpp"
#include "hal/sensor_settings.hpp"
#include "sim/device_faults.hpp"
#include "sim/scene/scene.hpp"
#include "sim/simulation.hpp"

namespace compueye::sim {

struct SimulatedEyeSettings {
  EyeToSimulate board;                       ///< its dead channels are invalid in every frame
  std::vector<Scene> scenes;                 ///< at least one; shown in turn, over and over
  int frames_per_scene = 1;                  ///< >= 1
  std::optional<Scene> display;              ///< what show() covers them with, by every effect that is called for
  Planning planning;                         ///< of every scene
  double frame_rate_hz = 0.0;                ///< 0: unpaced, a frame whenever one is read; else up to 1e6
  std::uint64_t seed = 0;                    ///< of every random draw
  int fifo_frames = 4;                       ///< frames the device keeps for a late reader, >= 1
  std::string serial = "sim-0";              ///< names the device and the place of its errors
  std::optional<std::uint64_t> frame_limit;  ///< frames the device makes after a start(), then end_of_stream
  DeviceFaults faults;
};

/// A compound eye without hardware, behind the interface of the real ones.
///
/// The device clock is the Clock's time since create(). After start() at device time t0, frame f is exposed from
/// t0 + f/rate to t0 + (f+1)/rate; SampleBlock::t_ns is the beginning and the frame can be read from the end on. A full
/// FIFO loses its oldest frame: the reader sees the frame number jump, the overrun flag and a device_overrun count.
/// Unpaced, a frame is exposed at the moment of the read and none is lost; t_ns then still grows by at least 1 ns.
///
/// Samples depend on settings and frame number only: not on pacing, on when they are read or on what was lost before.
/// account().produced counts the frames whose fate is settled; those still in the FIFO are settled by the next read()
/// or by stop(), which counts them as `stopped`. config_id is 0, the channels are the ommatidia in order.
class SimulatedEye final : public hal::SampleSource {
 public:
  /// Renders the first frame of every scene, so it may take seconds. `clock` must outlive the eye. Errors: those of
  /// Simulation::create(); usage (no scene), out_of_range.
  [[nodiscard]] static hal::Result<std::unique_ptr<SimulatedEye>> create(SimulatedEyeSettings settings,
                                                                         hal::Clock& clock);

  /// Told of the renderings of frames from now on. A read whose rendering it gives up is timed out, and the next one
  /// finds the same frame.
  void watch(const RenderWatch& watch);

  /// From the exposures on that begin now, the display's first surface shows `picture` (no pixels: no light at all),
  /// and goes there from what was seen with a time constant of `response_s`. Where the settings have no display the
  /// first scene is it. Errors: those of Simulation::show().
  [[nodiscard]] hal::Result<void> show(const hal::Image& picture, double response_s);
  /// The display is gone, and the eye sees its scenes again.
  void uncover() noexcept { change_.reset(); }

  /// The M signals that the optics deliver in frame `frame`, in fully seen pixels at white, and what the converter is
  /// given in LSB. Valid until the next frame.
  [[nodiscard]] std::span<const double> noise_free(std::uint64_t frame);
  [[nodiscard]] std::span<const double> levels_lsb(std::uint64_t frame);
  /// The effects of scene `scene_index` (0 .. scenes - 1), and why.
  [[nodiscard]] const Plan& plan(std::size_t scene_index) const noexcept;
  /// Which scene is shown in frame `frame`.
  [[nodiscard]] std::size_t scene_of_frame(std::uint64_t frame) const noexcept;
  [[nodiscard]] const SimulatedEyeSettings& settings() const noexcept { return settings_; }

 private:
  SimulatedEye(SimulatedEyeSettings settings, std::vector<Simulation> simulations, std::optional<Simulation> display,
               hal::Clock& clock);

  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return account_; }

  [[nodiscard]] bool paced() const noexcept { return settings_.frame_rate_hz > 0.0; }
  [[nodiscard]] std::int64_t exposure_start_ns(std::uint64_t frame) const noexcept;
  [[nodiscard]] std::uint64_t finished_frames(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool lost_on_the_way(std::uint64_t frame) const noexcept;
  void overwrite_oldest(std::uint64_t finished) noexcept;
  hal::Result<hal::SampleBlock> deliver(std::int64_t now_ns);
  [[nodiscard]] hal::Result<bool> codes_of(std::uint64_t frame, std::int64_t start_ns);
  [[nodiscard]] Simulation& display() noexcept { return display_ ? *display_ : simulations_.front(); }

  /// A change of light, in signals. A frame is given what there is at its beginning.
  struct Change {
    std::int64_t at_ns = 0;  // of the Clock
    double response_s = 0.0;
    std::vector<double> before, after;

    void light_at(std::int64_t t_ns, std::span<double> light) const noexcept;
  };

  SimulatedEyeSettings settings_;
  std::vector<Simulation> simulations_;  // one a scene
  std::optional<Simulation> display_;    // that covers them
  hal::Clock& clock_;
  hal::SourceDescription description_;
  std::int64_t power_on_ns_ = 0;  // Clock time of device time 0

  std::int64_t started_ns_ = 0;  // Clock time of start()
  std::int64_t last_t_ns_ = -1;  // device time of the last block, over all streams
  std::uint64_t next_ = 0;       // oldest frame whose fate is open
  bool overrun_pending_ = false;
  hal::FrameAccount account_;
  std::optional<Change> change_;
  std::vector<double> light_;
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
};

}  // namespace compueye::sim
