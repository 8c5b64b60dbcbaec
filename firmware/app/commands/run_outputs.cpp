#include "firmware/app/commands/run_outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/sinks/contact_sheet.hpp"
#include "firmware/sinks/frame_list_sink.hpp"
#include "firmware/sinks/sink_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

/// Hands every frame to several sinks in turn: files first, then the screen. The first refusal counts; a frame refused
/// by one is not offered to those after it.
class FanOutSink final : public hal::FrameSink {
 public:
  void add(std::unique_ptr<hal::FrameSink> sink) { sinks_.push_back(std::move(sink)); }

  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override {
    for (const auto& sink : sinks_) {
      if (auto opened = sink->open(format); !opened) {
        // Whatever was opened before must not leave its beginnings behind.
        static_cast<void>(close());
        return opened;
      }
    }
    return {};
  }
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override {
    for (const auto& sink : sinks_) {
      if (auto written = sink->write(frame); !written) return written;
    }
    return {};
  }
  [[nodiscard]] hal::Result<void> close() override {
    hal::Result<void> first;
    for (const auto& sink : sinks_) {
      if (auto closed = sink->close(); !closed && first) first = std::move(closed);
    }
    return first;
  }

 private:
  std::vector<std::unique_ptr<hal::FrameSink>> sinks_;
};

/// In a folder that is made for it.
hal::Result<void> try_output_below(const std::string& file) {
  TRY(make_folder(std::filesystem::path(file).parent_path(), "cannot be made to write into"));
  return try_output(file);
}

}  // namespace

hal::Result<std::optional<PictureFolder>> claim_outputs(const RunOptions& options) {
  std::optional<PictureFolder> folder;
  if (!options.out.empty()) folder = TRY(PictureFolder::claim(options.out));
  TRY(try_output_below(options.sheet));
  TRY(try_output_below(options.report));
  return folder;
}

bool shows_pictures(const RunOptions& options) {
  const bool terminal = ::isatty(STDOUT_FILENO) == 1;
  if (terminal && !terminal_can_draw()) return false;
  if (options.show) return *options.show;
  return options.stdout_owner.empty() && options.table.empty() && terminal;
}

RunSinks make_sinks(const RunOptions& options, Session& session, const LiveStatus& status,
                    std::vector<std::string>& files) {
  auto sinks = std::make_unique<FanOutSink>();
  const SinkWanted wanted{options.out, session.clock(), &status};
  const SinkRow& format = *find_sink(options.output_format());
  if (format.make != nullptr) {
    sinks->add(format.make(wanted));
    files.push_back(options.out + "/" + std::string(format.files));
    files.push_back(options.out + "/" + PictureFolder::frame_list);
    sinks->add(std::make_unique<FrameListSink>(files.back()));
  }
  if (!shows_pictures(options)) {
    if (options.show.value_or(false)) {
      session.note("--show: the terminal cannot show pictures, because TERM is \"dumb\" or not set");
    }
    return {std::move(sinks)};
  }
  auto screen = find_sink("terminal")->make(wanted);
  auto* const user = dynamic_cast<TerminalSink*>(screen.get());
  session.guard_screen({[user] { user->give_back(); }, [user] { user->take_again(); }});
  sinks->add(std::move(screen));
  return {std::move(sinks), user};
}

hal::Result<void> write_run_sheet(const std::string& path, const Figures& run, const hal::Image& truth,
                                  const hal::Image& conventional, const hal::Image& last) {
  using Lines = std::vector<std::string>;
  std::vector<Panel> panels;
  panels.push_back({"scene", {fmt::format("{} x {} pixels", truth.rows, truth.cols)}, truth});
  if (!conventional.pixels.empty()) {
    panels.push_back(
        {"conventional eye",
         Lines{run.sentence("NMSE {conventional.nmse:3}"), run.sentence("PSNR {conventional.psnr_db:.1} dB"),
               run.sentence("SSIM {conventional.ssim:.3}")},
         conventional});
  }
  panels.push_back(
      {run.sentence("reconstruction, frame {last.frame}"),
       Lines{
           run.sentence("NMSE {last.quality.nmse:3}"), run.sentence("PSNR {last.quality.psnr_db:.1} dB"),
           run.sentence("SSIM {last.quality.ssim:.3}"),
           run.sentence("{operating_point.solver}, {operating_point.basis}, {operating_point.iterations} iterations")},
       last});
  panels.push_back(TRY(error_panel(last, truth)));
  return write_contact_sheet(path, run.sentence("{eye.board}: {scene} at {distance_mm} mm"), panels);
}

}  // namespace compueye::firmware
