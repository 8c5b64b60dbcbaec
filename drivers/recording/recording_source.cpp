#include "drivers/recording/recording_source.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "hal/try.hpp"

namespace compueye::recording {
namespace {

std::string path_of_run(const std::string& first, int run) {
  if (run == 1) return first;
  const std::filesystem::path path = first;
  return path.parent_path() / (path.stem().string() + "-" + std::to_string(run) + path.extension().string());
}

}  // namespace

hal::Result<std::unique_ptr<RecordingSource>> RecordingSource::create(RecordingSettings settings,
                                                                      hal::SampleSource& source, hal::Clock& clock) {
  TRY(check_header({source.describe(), 0, settings.settings}));
  return std::unique_ptr<RecordingSource>(new RecordingSource(std::move(settings), source, clock));
}

RecordingSource::~RecordingSource() {
  stop();
}

hal::Result<void> RecordingSource::do_start() {
  const auto channels = static_cast<std::size_t>(source_.describe().channels);
  const std::size_t frame_bytes = channels * (sizeof(std::int32_t) + 1) + sizeof(WaitingFrame);
  waiting_ =
      std::make_unique<WaitingFrames>(std::max<std::size_t>(4, settings_.most_waiting_bytes / frame_bytes), channels);
  started_ns_ = clock_.now_ns();
  TRY(source_.start());
  path_ = path_of_run(settings_.path, runs_ + 1);
  auto writer = RecordingWriter::create(
      path_, {source_.describe(), started_ns_ + settings_.unix_minus_clock_ns, settings_.settings},
      settings_.sync_interval_ns);
  if (!writer) {
    source_.stop();
    return tl::unexpected(std::move(writer.error()));
  }
  writer_ = std::move(*writer);
  ending_ = Ending::stopped;
  looked_ns_ = 0;
  now_ns_ = 0;
  recorded_ = skipped_ = refused_ = 0;
  bytes_ = writer_->bytes();
  failed_ = false;
  error_.reset();
  try {
    thread_ = std::thread([this] { write_waiting(); });
  } catch (const std::system_error& error) {
    source_.stop();
    writer_->discard();
    writer_.reset();
    return hal::fail(hal::ErrorCode::io, path_, std::string("no thread to write it: ") + error.what());
  }
  ++runs_;
  return {};
}

hal::Result<hal::SampleBlock> RecordingSource::do_read(std::int64_t deadline_ns) {
  if (settings_.stop_on_failure && failed()) {
    ending_ = Ending::source_failed;
    return tl::unexpected(*error_);
  }
  auto block = source_.read(deadline_ns);
  look_after_file();
  if (block) {
    keep(*block);
  } else if (block.error().code == hal::ErrorCode::end_of_stream) {
    ending_ = Ending::end_of_stream;
  } else if (block.error().code != hal::ErrorCode::timeout && block.error().code != hal::ErrorCode::interrupted) {
    ending_ = Ending::source_failed;
  }
  return block;
}

void RecordingSource::keep(const hal::SampleBlock& block) noexcept {
  WaitingFrame* const slot = failed() ? nullptr : waiting_->claim(settings_.when_full == WhenFull::wait);
  if (slot == nullptr || block.codes.size() != slot->codes.size() || block.valid.size() != slot->valid.size()) {
    skipped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  std::copy(block.codes.begin(), block.codes.end(), slot->codes.begin());
  std::copy(block.valid.begin(), block.valid.end(), slot->valid.begin());
  slot->block = block;
  slot->block.codes = slot->codes;
  slot->block.valid = slot->valid;
  slot->arrival_ns = clock_.now_ns() - started_ns_;
  slot->account = source_.account();
  slot->skipped = skipped_.load(std::memory_order_relaxed);
  waiting_->push();
}

void RecordingSource::note(hal::Result<void> done) noexcept {
  if (done || failed_) return;
  if (!error_) error_ = std::move(done.error());
}

/// Time passes whether frames come or not, and only who reads knows how much of it: the clock may be a virtual one.
void RecordingSource::look_after_file() noexcept {
  const std::int64_t now_ns = clock_.now_ns() - started_ns_;
  if (settings_.sync_interval_ns <= 0 || now_ns - looked_ns_ < settings_.sync_interval_ns) return;
  looked_ns_ = now_ns;
  now_ns_.store(now_ns, std::memory_order_relaxed);
  waiting_->wake();
}

void RecordingSource::write_waiting() noexcept {
  while (!waiting_->drained()) {
    const WaitingFrame* const frame = waiting_->oldest();
    const std::uint64_t refused = refused_.load(std::memory_order_relaxed);
    auto done = frame != nullptr
                    ? writer_->append(frame->block, frame->arrival_ns, frame->account, frame->skipped + refused)
                    : writer_->flush_if_due(now_ns_.load(std::memory_order_relaxed));
    if (frame != nullptr) waiting_->done();
    recorded_.store(writer_->frames(), std::memory_order_relaxed);
    bytes_.store(writer_->bytes(), std::memory_order_relaxed);
    if (done) continue;
    if (frame != nullptr) refused_.store(refused + 1, std::memory_order_relaxed);
    note(std::move(done));
    if (writer_->failed()) failed_.store(true, std::memory_order_release);
  }
}

void RecordingSource::do_stop() noexcept {
  source_.stop();
  waiting_->close();
  thread_.join();
  note(writer_->finish(ending_, clock_.now_ns() - started_ns_, source_.account(), unrecorded()));
  refused_ += recorded_ - writer_->frames();
  recorded_ = writer_->frames();
  bytes_ = writer_->bytes();
  writer_.reset();
}

}  // namespace compueye::recording
