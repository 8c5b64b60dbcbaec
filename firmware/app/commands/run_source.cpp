#include "firmware/app/commands/run_source.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include "drivers/device/hang_proof_source.hpp"
#include "drivers/recording/recording_file.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/settings/board_lines.hpp"
#include "firmware/files/output_target.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
using hal::Result;

namespace {

/// Lines "key = value".
std::string header_text(const RecordingRequest& request, const Board& board) {
  std::string text = board_lines(board) + request.pictures;
  if (!board.source.simulated()) return text;
  return text + fmt::format("scene = {}\nscene_seed = {}\nseed = {}\n", visible_text(request.scene), request.scene_seed,
                            request.seed);
}

std::string problem_of(const ReadyEye& eye) {
  const recon::Objective& objective = eye.reconstructor().objective();
  return fmt::format("{} {} {} {} {}", name(eye.reconstructor().plan().solver), name(objective.basis),
                     name(objective.constraint), objective.lo, objective.hi);
}

/// lambda by hand is said again by hand.
std::string lambda_lines(const ReadyEye& eye) {
  const LambdaChoice& lambda = eye.lambda();
  if (lambda.origin == LambdaOrigin::hand) return {};
  return fmt::format("lambda = {}\nlambda_rule = {}\nlambda_of = {}\n", lambda.value, lambda.rule, problem_of(eye));
}

/// Empty where nothing differs.
std::string mismatch_of(const recording::RecordingReader& recording, const Board& board) {
  const auto differences = board_differences(recording.header().settings, board);
  if (differences.empty()) return {};
  return fmt::format("{} was recorded with another board: {}; expect pictures that are wrong", recording.place(),
                     text_of(differences));
}

std::string picture_lines(const ReadyEye& eye) {
  return lambda_lines(eye) + (eye.measured() != nullptr ? provenance_lines(*eye.measured()) : std::string());
}

std::int64_t unix_minus(const hal::Clock& clock) {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count() - clock.now_ns();
}

}  // namespace

Result<void> check_new_recording(const std::string& path) {
  if (named_stream(path)) return {};
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (std::filesystem::is_regular_file(path, ignored)) {
    return tl::unexpected(recording::file_failure(EEXIST, path, "cannot be written"));
  }
  if (!std::filesystem::is_directory(parent.empty() ? "." : parent, ignored)) {
    return tl::unexpected(recording::file_failure(ENOENT, path, "cannot be written"));
  }
  return {};
}

Result<std::unique_ptr<recording::RecordingSource>> with_recorder(const RecordingRequest& request, const Board& board,
                                                                  hal::SampleSource& source, hal::Clock& clock) {
  recording::RecordingSettings settings;
  settings.path = named_stream(request.path) == STDOUT_FILENO ? "-" : request.path;
  settings.settings = header_text(request, board) + source.describe().provenance;
  settings.unix_minus_clock_ns = unix_minus(clock);
  settings.when_full = request.lossless ? recording::WhenFull::wait : recording::WhenFull::skip;
  settings.stop_on_failure = request.stop_on_failure;
  return recording::RecordingSource::create(std::move(settings), source, clock);
}

Result<RunSource> RunSource::make(const RunOptions& options, const Board& board, const sim::Scene& scene,
                                  std::uint64_t frames, hal::Clock& clock, const recon::Progress& progress) {
  RunSource made;
  if (options.replays()) {
    auto replay = TRY(recording::ReplaySource::open(options.replay, options.pace(), clock));
    TRY(check_fits(replay->describe(), board, options.replay));
    made.replay_ = replay.get();
    made.mismatch_ = mismatch_of(replay->recording(), board);
    made.eye_.source = std::move(replay);
    return made;
  }
  EyeWanted wanted{scene, options.seed, options.lossless, std::nullopt, progress};
  // Without a limit the frames read ahead of the last one would be made only to be thrown away.
  if (options.lossless && frames > 0 && !options.check_every_s) wanted.frame_limit = frames;
  if (options.check_every_s && board.source.simulated()) {
    wanted.display = TRY(display_of_patterns(board, plain_display(board), options.seed));
  }
  made.eye_ = TRY(board_eye(board, std::move(wanted), clock));
  return made;
}

void RunSource::render_while(std::function<bool()> go_on) {
  if (eye_.simulated == nullptr) return;
  eye_.simulated->watch([go_on = std::move(go_on)](std::string_view, double) { return go_on(); });
}

void RunSource::add_checks(CheckSettings settings, hal::Clock& clock) {
  checked_ = std::make_unique<CheckedSource>(std::move(settings), *eye_.source, clock);
}

Result<void> RunSource::begin_recording(const RunOptions& options, const Board& board, const sim::Scene& scene,
                                        const ReadyEye& eye, hal::Clock& clock) {
  if (options.record.empty()) return {};
  recorder_ = TRY(with_recorder({options.record, scene.name, options.scene.seed, options.seed, options.lossless,
                                 options.stop_if_unrecorded, picture_lines(eye)},
                                board, source(), clock));
  return {};
}

std::optional<double> RunSource::recorded_lambda(const ReadyEye& eye) const {
  if (replay_ == nullptr) return std::nullopt;
  const std::string& header = replay_->recording().header().settings;
  if (value_in(header, "lambda_rule") != fmt::format("{}", eye.lambda().rule)) return std::nullopt;
  if (value_in(header, "lambda_of") != problem_of(eye)) return std::nullopt;
  return typed_number(value_in(header, "lambda").value_or(std::string()));
}

hal::SampleSource& RunSource::source() noexcept {
  if (recorder_) return *recorder_;
  if (checked_) return *checked_;
  return *eye_.source;
}

std::string RunSource::name() const {
  const hal::SourceDescription& d = eye_.source->describe();
  return d.backend + " " + d.serial + (replay_ != nullptr ? " from " + replay_->recording().place() : std::string());
}

std::vector<std::string> RunSource::notes() const {
  std::vector<std::string> notes;
  if (eye_.hang_proof != nullptr && eye_.hang_proof->hang()) {
    notes.push_back("the eye was left as it was: " + eye_.hang_proof->hang()->text());
  }
  if (replay_ != nullptr) {
    const recording::RecordingDamage& damage = replay_->recording().damage();
    const std::string& file = replay_->recording().place();
    if (damage.stretches > 0) {
      notes.push_back(fmt::format("{}: {} damaged bytes, the first at byte {}, which cost {} frames", file,
                                  damage.bytes, damage.first_at, damage.blocks));
    }
    if (damage.torn_bytes > 0) {
      notes.push_back(fmt::format("{}: a torn tail of {} bytes from byte {} on is not read", file, damage.torn_bytes,
                                  damage.torn_at));
    }
  }
  if (recorder_ && recorder_->unrecorded() > 0) {
    notes.push_back(fmt::format("{}: {} frames are not in it, which {}", recorder_->path(), recorder_->unrecorded(),
                                recorder_->failed() ? recorder_->error()->sentence : "did not keep up"));
  }
  return notes;
}

std::string RunSource::failure() const {
  if (!recorder_ || !recorder_->failed()) return {};
  return recorder_->error()->text() + "; " +
         (recorder_->stops_on_failure() ? "the run ends" : "the run goes on and no frame is recorded from now on");
}

Result<void> RunSource::recorded() const {
  if (recorder_ && recorder_->error()) return tl::unexpected(*recorder_->error());
  return {};
}

}  // namespace compueye::firmware
