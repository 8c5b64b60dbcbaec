#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "firmware/eye/board.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"
#include "recon/problem/progress.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::device {
class EyeControls;
class HangProofSource;
}  // namespace compueye::device
namespace compueye::sim {
class SimulatedEye;
}

namespace compueye::firmware {

/// What a command asks of a board's eye.
struct EyeWanted {
  sim::Scene scene;        ///< in front of a simulated eye
  std::uint64_t seed = 0;  ///< of a simulated eye's noise
  bool lossless = false;   ///< a simulated eye waits for its reader instead of keeping the board's rate
  std::optional<std::uint64_t> frame_limit;  ///< frames that a simulated eye makes at most
  recon::Progress progress = {};             ///< of what a simulated eye's plan and first frame may take
  std::optional<sim::Scene> display = {};    ///< that a simulated eye's scene can be covered with
};

/// The eye of a board, and which kind it is: some lights are the eye's own.
struct BoardEye {
  std::unique_ptr<hal::SampleSource> source;
  sim::SimulatedEye* simulated = nullptr;         ///< the source, or null
  device::EyeControls* attached = nullptr;        ///< likewise: an eye on a cable
  device::HangProofSource* hang_proof = nullptr;  ///< likewise: one whose driver may hang
};

/// The eye of a board: simulated, or on a cable and identified: the board's serial, or the first one there is where the
/// board names none, exposed as it was measured. `clock` is a simulated eye's and must outlive it. Errors: those of
/// planned_eye() and real_eye(); mismatch (an eye of another number of channels or depth than the board says), usage
/// (--lossless on a cable).
[[nodiscard]] hal::Result<BoardEye> board_eye(const Board& board, EyeWanted wanted, hal::Clock& clock);

/// Its source alone.
[[nodiscard]] hal::Result<std::unique_ptr<hal::SampleSource>> board_source(const Board& board, EyeWanted wanted,
                                                                           hal::Clock& clock);

/// The eye of a board that is not simulated, exposed for as long as its rate allows, however it was measured: on the
/// kernel's monotonic clock, and with a driver that can hold nobody up. Errors: those of DeviceSource::create(),
/// wired_eye() and device::HangProofSource::create(); mismatch as above.
[[nodiscard]] hal::Result<BoardEye> real_eye(const Board& board);

/// Whether a source is of as many channels and as deep as the board's eye. Error mismatch at `place`.
[[nodiscard]] hal::Result<void> check_fits(const hal::SourceDescription& source, const Board& board,
                                           const std::string& place);

/// The bare cable to an eye, not opened: to the one with this serial, or with an empty one to the first there is.
[[nodiscard]] std::unique_ptr<hal::ByteTransport> connect(const protocol::Bus& bus, const std::string& serial);

/// An eye on a cable: where it is, and what it says of itself or why it could not be asked.
struct AttachedEye {
  std::string kind;  ///< as [source] kind names it
  std::string bus;   ///< "usb 1-4", "hidraw2"
  std::string serial;
  std::string product;
  hal::Result<hal::SourceDescription> description;
};

struct AttachedEyes {
  std::vector<AttachedEye> eyes;   ///< by kind, then bus
  std::vector<std::string> notes;  ///< a bus that could not be looked at, a sentence each
};

/// Looks for eyes on every bus and asks each what it is, for a second at most, and ten where its driver hangs. An eye
/// that another program runs is listed with the reason why it could not be asked.
[[nodiscard]] AttachedEyes list_attached_eyes();

}  // namespace compueye::firmware
