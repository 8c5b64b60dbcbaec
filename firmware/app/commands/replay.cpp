#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "firmware/app/command.hpp"
#include "firmware/text/date.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using recording::RecordingDamage;
using recording::RecordingReader;

/// Frames that are missing between two recorded ones.
struct FrameGap {
  std::uint64_t before_frame = 0;  ///< number of the frame that came after the gap
  std::uint64_t frames = 0;
};

/// What a recording holds, gathered while it is read.
class RecordingSummary {
 public:
  static constexpr std::size_t most_listed_gaps = 20;

  void add(const recording::RecordedFrame& frame);

  /// `reader` has been read to its end.
  [[nodiscard]] Figures report(const recording::RecordingReader& reader) const;

 private:
  std::uint64_t frames_ = 0;
  std::uint64_t next_frame_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t missing_ = 0;         // in them
  std::vector<FrameGap> first_gaps_;  // most_listed_gaps of them
  std::uint64_t saturated_ = 0, dark_ = 0, overrun_ = 0, untrusted_times_ = 0;
  std::uint64_t invalid_samples_ = 0;
  std::uint64_t configurations_ = 0;  // times that config_id changed, and the first
  std::optional<std::uint32_t> last_config_;
  std::int64_t first_arrival_ns_ = 0, last_arrival_ns_ = 0;
};

/// "key = value" lines as "key = value, ...", without those that spell the board out.
std::string one_line(std::string_view settings) {
  std::string text;
  while (!settings.empty()) {
    const std::size_t end = std::min(settings.find('\n'), settings.size());
    const std::string_view line = settings.substr(0, end);
    settings.remove_prefix(std::min(end + 1, settings.size()));
    if (line.empty() || line.starts_with("board.")) continue;
    text += (text.empty() ? "" : ", ") + std::string(line);
  }
  return visible_text(text);
}

void RecordingSummary::add(const recording::RecordedFrame& recorded) {
  const hal::SampleBlock& block = recorded.block;
  if (block.frame > next_frame_) {
    ++gaps_;
    missing_ += block.frame - next_frame_;
    if (first_gaps_.size() < most_listed_gaps) first_gaps_.push_back({block.frame, block.frame - next_frame_});
  }
  next_frame_ = block.frame + 1;
  saturated_ += block.flags.saturated ? 1U : 0U;
  dark_ += block.flags.dark ? 1U : 0U;
  overrun_ += block.flags.overrun ? 1U : 0U;
  untrusted_times_ += block.flags.time_ok ? 0U : 1U;
  invalid_samples_ += static_cast<std::uint64_t>(std::count(block.valid.begin(), block.valid.end(), 0));
  if (last_config_ != block.config_id) ++configurations_;
  last_config_ = block.config_id;
  if (frames_++ == 0) first_arrival_ns_ = recorded.arrival_ns;
  last_arrival_ns_ = recorded.arrival_ns;
}

Figures RecordingSummary::report(const RecordingReader& reader) const {
  const hal::SourceDescription& s = reader.header().source;
  const RecordingDamage& damage = reader.damage();
  Value::List gaps;
  for (const FrameGap& gap : first_gaps_) {
    gaps.push_back(Figures{{"before_frame", gap.before_frame}, {"frames", gap.frames}});
  }
  Value end;
  if (reader.end()) end = Figures{{"why", name(reader.end()->ending)}, {"at_ns", reader.end()->at_ns}};
  Figures f{{"file", reader.place()},
            {"file_bytes", reader.file_bytes()},
            {"began_unix_ns", reader.header().began_unix_ns},
            {"source", Figures{{"backend", s.backend},
                               {"serial", s.serial},
                               {"firmware", s.firmware},
                               {"channels", s.channels},
                               {"bits", s.bits},
                               {"frame_rate_hz", s.frame_rate_hz}}},
            {"settings", reader.header().settings},
            {"frames", figures_of(reader.account())},
            {"unrecorded", reader.unrecorded()},
            {"gaps", Figures{{"count", gaps_}, {"missing_frames", missing_}, {"first", std::move(gaps)}}},
            {"span_ns", last_arrival_ns_ - first_arrival_ns_},
            {"saturated_frames", saturated_},
            {"dark_frames", dark_},
            {"overrun_flags", overrun_},
            {"untrusted_times", untrusted_times_},
            {"invalid_samples", invalid_samples_},
            {"configurations", configurations_},
            {"damage", Figures{{"places", damage.stretches},
                               {"bytes", damage.bytes},
                               {"first_at_byte", damage.stretches > 0 ? Value(damage.first_at) : Value()},
                               {"frames", damage.blocks}}},
            {"torn_tail", Figures{{"bytes", damage.torn_bytes},
                                  {"at_byte", damage.torn_bytes > 0 ? Value(damage.torn_at) : Value()}}},
            {"end", std::move(end)}};
  f.tell("{file}: {file_bytes:bytes}, recorded ").say(utc(reader.header().began_unix_ns / 1'000'000'000) + "\n");
  f.tell(
      "source: {source.backend} {source.serial}, firmware {source.firmware}; {source.channels} channels of "
      "{source.bits} bits, ");
  f.tell(s.frame_rate_hz > 0.0 ? "{source.frame_rate_hz:6} frames a second\n" : "unpaced\n");
  if (!reader.header().settings.empty()) f.say("settings: " + one_line(reader.header().settings) + "\n");
  f.tell(
      "frames: {frames.produced} produced = {frames.delivered} recorded + {frames.dropped:sum} dropped"
      "[ ({frames.dropped})][, {frames.estimated} of them by estimate][; {unrecorded} of them were too much for the "
      "recorder]\n"
      "[gaps: {gaps.count} with {gaps.missing_frames} frames missing, before frame]");
  for (const FrameGap& gap : first_gaps_) f.say(fmt::format(" {} ({})", gap.before_frame, gap.frames));
  if (gaps_ > 0) f.say(gaps_ > first_gaps_.size() ? " ...\n" : "\n");
  f.tell(
      "spread over {span_ns:ns}; {saturated_frames} saturated, {dark_frames} dark, {overrun_flags} with overrun "
      "flag, {untrusted_times} with an untrusted time; {invalid_samples} invalid samples; "
      "{configurations:# configuration}\n"
      "[damaged: {damage.bytes} bytes in {damage.places:# place}, the first at byte {damage.first_at_byte}; "
      "{damage.frames:# frame} lost there\n]"
      "[torn tail: {torn_tail.bytes} bytes of an unfinished block from byte {torn_tail.at_byte} on\n]");
  return f.tell(reader.end() ? "ended: {end.why}\n" : "cut off: there is no end block\n");
}

struct ReplayRequest {
  std::string file;
};

/// Reads a whole recording and prints what it is, what is in it, which frames are missing and why, and what is damaged
/// or torn. A damaged recording is reported and no error; one whose header cannot be read is.
hal::Result<void> replay(const ReplayRequest& request, Session& session) {
  auto reader = TRY(recording::RecordingReader::open(request.file));
  const recon::Progress progress = session.progress();
  RecordingSummary summary;
  for (;;) {
    const auto frame = reader.next();
    if (!frame && frame.error().code == hal::ErrorCode::end_of_stream) break;
    summary.add(TRY(frame));
    progress("reading", static_cast<double>(reader.position()), static_cast<double>(reader.file_bytes()));
  }
  session.end_progress();
  return session.print(summary.report(reader));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ReplayRequest>();
  options.add("file", o->file, "the recording, such as eye.rec").required();
  options.json("print one object with every figure and nothing else on stdout");
  return action_of(o, replay);
}

std::string footer() {
  return "Reads every block and checks it: description, frames, gaps and their reasons, damage, torn tail. A damaged "
         "recording is reported with exit code 0; exit code 1 is for one that cannot be read at all. `compueye run "
         "--replay` makes pictures of it.\n\n"
         "Examples:\n"
         "  compueye replay eye.rec\n"
         "  compueye run --board boards/sim-8x8 --replay eye.rec --out pictures";
}

}  // namespace

extern const Command replay_command;
const Command replay_command{"replay", "what is in a recording, frame by frame, and what is missing",
                             OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
