// Set-up and recovery of device::ConverterSource.

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/device/converter_source.hpp"
#include "hal/try.hpp"

namespace compueye::device {
namespace {

using hal::ErrorCode;

/// The wires that a kind of chip needs, but for those that its front end asks for when it uses them.
hal::Result<void> check_wires(const ConverterSettings& settings, const ConverterWires& wires) {
  const frontend::FrontEndRow& chip = *settings.chip;
  const auto missing = [&](const char* what) {
    return hal::fail(ErrorCode::usage, std::string(chip.name), std::string("needs ") + what + ", and there is none");
  };
  if (!wires.data) return missing("an SPI bus for its data");
  if (chip.settings_bus && !wires.settings) return missing("an SPI bus for its settings");
  if (chip.data_ready != (wires.ready != nullptr)) {
    return chip.data_ready ? missing("a line that says that data are ready")
                           : hal::fail(ErrorCode::usage, std::string(chip.name), "says nothing of data that are ready");
  }
  return {};
}

}  // namespace

hal::Result<std::unique_ptr<ConverterSource>> ConverterSource::create(ConverterSettings settings, ConverterWires wires,
                                                                      hal::Clock& clock) {
  TRY(check_wires(settings, wires));
  auto front_end = TRY(settings.chip->make(settings.front_end));
  const auto channels = static_cast<std::size_t>(front_end->channels());
  if (!settings.ommatidium_of_channel.empty() && settings.ommatidium_of_channel.size() != channels) {
    return hal::fail(ErrorCode::mismatch, std::string(settings.chip->name),
                     "has " + std::to_string(channels) + " channels, and ommatidia are given for " +
                         std::to_string(settings.ommatidium_of_channel.size()));
  }
  std::unique_ptr<ConverterSource> source(new ConverterSource(std::move(settings), std::move(wires), clock));
  source->front_end_ = std::move(front_end);
  source->codes_.resize(channels);
  source->valid_.resize(channels);
  hal::SourceDescription& is = source->description_;
  const ConverterSettings& wanted = source->settings_;
  is.backend = "spi";
  is.serial = wanted.serial.empty() ? source->wires_.data->describe().name : wanted.serial;
  is.firmware = std::string(wanted.chip->title);
  is.channels = static_cast<int>(channels);
  is.bits = wanted.chip->bits;
  is.frame_rate_hz = wanted.front_end.frame_rate_hz;
  is.ommatidium_of_channel = wanted.ommatidium_of_channel;
  for (std::size_t c = is.ommatidium_of_channel.size(); c < channels; ++c) {
    is.ommatidium_of_channel.push_back(static_cast<std::int32_t>(c));
  }
  source->period_ns_ = std::max<std::int64_t>(1, std::llround(1e9 / wanted.front_end.frame_rate_hz));
  source->silence_ns_ =
      wanted.silence_ns != 0 ? wanted.silence_ns : std::max<std::int64_t>(5 * source->period_ns_, 50'000'000);
  TRY(source->open_wires());
  TRY(source->set_up());
  return source;
}

ConverterSource::ConverterSource(ConverterSettings settings, ConverterWires wires, hal::Clock& clock)
    : settings_(std::move(settings)), wires_(std::move(wires)), clock_(clock), back_off_(settings_.back_off) {}

ConverterSource::~ConverterSource() {
  stop();
  close_wires();
}

hal::Result<void> ConverterSource::open_wires() {
  wires_open_ = true;  // some of them
  hal::SpiMode mode = settings_.chip->spi;
  if (settings_.front_end.clock_hz != 0) mode.clock_hz = settings_.front_end.clock_hz;
  TRY(wires_.data->open(mode));
  if (wires_.settings) TRY(wires_.settings->open(mode));
  for (hal::OutputLines* lines : {wires_.select.get(), wires_.reset.get(), wires_.sync.get()}) {
    if (lines != nullptr) TRY(lines->open());
  }
  return {};
}

void ConverterSource::close_wires() noexcept {
  wires_.data->close();
  if (wires_.settings) wires_.settings->close();
  for (hal::OutputLines* lines : {wires_.select.get(), wires_.reset.get(), wires_.sync.get()}) {
    if (lines != nullptr) lines->close();
  }
  if (wires_.ready) wires_.ready->close();
  wires_open_ = false;
}

hal::Result<void> ConverterSource::set_up() {
  return front_end_->configure({wires_.data.get(), wires_.settings.get(), wires_.select.get(), wires_.reset.get()},
                               clock_);
}

hal::Result<void> ConverterSource::do_start() {
  failures_ = {};
  account_ = {};
  outages_ = overruns_ = 0;
  in_outage_ = given_up_ = false;
  recovering_.store(false, std::memory_order_relaxed);
  if (!wires_open_) TRY(open_wires());
  TRY(set_up());
  return begin_stream();
}

hal::Result<void> ConverterSource::begin_stream() {
  if (wires_.ready) {
    wires_.ready->close();  // what came meanwhile is of no frame of ours
    TRY(wires_.ready->open());
  }
  pace_.begin(period_ns_);
  frame_edge_.reset();
  bad_frames_ = frames_of_stream_ = 0;
  last_frame_ns_ = turn_ns_ = clock_.now_ns();
  streaming_ = true;
  return {};
}

void ConverterSource::count_failed(const hal::Error& error) noexcept {
  switch (error.code) {
    case ErrorCode::not_found:
      ++failures_[ConverterFailure::absent];
      return;
    case ErrorCode::disconnected:
      ++failures_[ConverterFailure::gone];
      return;
    case ErrorCode::mismatch:
      ++failures_[ConverterFailure::wrong_chip];
      return;
    default:
      ++failures_[!streaming_                                           ? ConverterFailure::open_failed
                  : wires_.ready && error.place == wires_.ready->name() ? ConverterFailure::line_error
                                                                        : ConverterFailure::bus_error];
  }
}

/// Frames that were complete by now and that nobody has asked for are lost; how many those are, time alone says.
void ConverterSource::lose_stream(hal::Error error) {
  const std::int64_t now_ns = clock_.now_ns();
  if (wires_.ready) {
    const std::uint64_t unseen = pace_.unseen(now_ns);
    drop(unseen, hal::DropReason::transport_gap);
    account_.estimated += unseen;
  }
  streaming_ = false;
  if (in_outage_) {
    attempt_failed(std::move(error));
    return;
  }
  in_outage_ = true;
  ++outages_;
  outage_ns_ = resume_ns_ = now_ns;
  attempts_ = 0;
  back_off_.reset();
  recovering_.store(true, std::memory_order_relaxed);
  last_error_ = std::move(error);
  give_up_when_over(now_ns);
}

void ConverterSource::give_up_when_over(std::int64_t now_ns) {
  if (now_ns - outage_ns_ < settings_.recovery_limit_ns) return;
  given_up_ = true;
  recovering_.store(false, std::memory_order_relaxed);
  ++failures_[ConverterFailure::gave_up];
}

void ConverterSource::attempt_failed(hal::Error error) {
  const std::int64_t now_ns = clock_.now_ns();
  ++attempts_;
  resume_ns_ = now_ns + back_off_.next_ns();
  last_error_ = std::move(error);
  give_up_when_over(now_ns);
}

void ConverterSource::recover(std::int64_t deadline_ns) {
  clock_.sleep_until_ns(std::min(resume_ns_, deadline_ns));
  if (clock_.now_ns() < resume_ns_) return;
  if (auto done = attempt(); !done) {
    count_failed(done.error());
    attempt_failed(std::move(done.error()));
  }
}

/// The first one leaves the device files open.
hal::Result<void> ConverterSource::attempt() {
  if (attempts_ > 0 || last_error_.code == ErrorCode::disconnected) {
    close_wires();
    ++failures_[ConverterFailure::reopen];
    TRY(open_wires());
  }
  TRY(set_up());
  TRY(begin_stream());
  ++failures_[ConverterFailure::restart];
  return {};
}

}  // namespace compueye::device
