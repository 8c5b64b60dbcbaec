#include "drivers/frontend/emulated_front_end.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace compueye::frontend {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t bits_of_byte = 8;

}  // namespace

EmulatedFrontEnd::EmulatedFrontEnd(EmulatedFrontEndSettings settings, std::int64_t now_ns)
    : settings_(std::move(settings)), now_ns_(now_ns), host_origin_ns_(now_ns) {
  for (int chip = 0; chip < settings_.front_end.chips; ++chip) chips_.push_back(settings_.chip->emulate());
  std::vector<ChipEmulator*> wired;
  for (const auto& chip : chips_) wired.push_back(chip.get());
  clocked_.emplace(std::move(wired), settings_.chip->chain ? Hookup::chain : Hookup::addressed);
  edges_.reserve(settings_.kernel_edges);
  codes_.resize(static_cast<std::size_t>(settings_.chip->channels) * chips_.size());
  power_on(now_ns);
}

double EmulatedFrontEnd::period_ns() const noexcept {
  return 1e9 / settings_.front_end.frame_rate_hz * (1.0 + drift_);
}

void EmulatedFrontEnd::power_on(std::int64_t now_ns) {
  for (auto& chip : chips_) chip->power_on();
  next_ns_ = static_cast<double>(now_ns) + period_ns();
}

void EmulatedFrontEnd::begin(const FrontEndFault& fault) {
  switch (fault.kind) {
    case FrontEndFaultKind::clock_drift:
      drift_ = static_cast<double>(fault.value) * 1e-6;
      return;
    case FrontEndFaultKind::other_chip:
      impostor_ = front_ends()[static_cast<std::size_t>(fault.value)]->emulate();
      impostor_->power_on();
      clocked_.emplace(std::vector<ChipEmulator*>{impostor_.get()}, Hookup::alone);
      return;
    case FrontEndFaultKind::gone:
      gone_until_ns_ = fault.duration_ns == 0 ? never : fault.at_ns + fault.duration_ns;
      return;
    case FrontEndFaultKind::edge_storm:
      storm_next_ns_ = fault.at_ns;
      break;
    default:
      break;
  }
  under_way_.push_back(fault);
}

void EmulatedFrontEnd::advance(std::int64_t now_ns) {
  for (;;) {
    // What happens first: a fault, the return of what was gone, a conversion, an edge of a storm.
    const auto fault = std::min_element(waiting_.begin(), waiting_.end(),
                                        [](const auto& a, const auto& b) { return a.at_ns < b.at_ns; });
    const std::int64_t fault_ns = fault == waiting_.end() ? never : std::max(fault->at_ns, now_ns_);
    const std::int64_t back_ns = gone_until_ns_ == 0 ? never : gone_until_ns_;
    const std::int64_t conversion_ns = settings_.chip->data_ready ? static_cast<std::int64_t>(next_ns_) : never;
    const FrontEndFault* const storm = lasting(FrontEndFaultKind::edge_storm);
    const std::int64_t storm_ns = storm == nullptr ? never : storm_next_ns_;
    const std::int64_t first_ns = std::min(std::min(fault_ns, back_ns), std::min(conversion_ns, storm_ns));
    if (first_ns > now_ns) break;
    now_ns_ = std::max(now_ns_, first_ns);
    std::erase_if(under_way_, [&](const FrontEndFault& each) {
      return each.duration_ns > 0 && now_ns_ >= each.at_ns + each.duration_ns;
    });
    if (first_ns == fault_ns) {
      FrontEndFault begun = *fault;
      begun.at_ns = now_ns_;
      waiting_.erase(fault);
      begin(begun);
    } else if (first_ns == back_ns) {
      gone_until_ns_ = 0;
      power_on(now_ns_);
    } else if (first_ns == conversion_ns) {
      next_ns_ += period_ns();
      if (gone_until_ns_ == 0) convert(converted_++);
    } else if (storm != nullptr) {
      storm_next_ns_ += std::max<std::int64_t>(storm->value, 1);
      edge(first_ns, true);
    }
  }
  now_ns_ = std::max(now_ns_, now_ns);
  std::erase_if(under_way_, [&](const FrontEndFault& each) {
    return each.duration_ns > 0 && now_ns_ >= each.at_ns + each.duration_ns;
  });
}

/// A conversion is complete; chips that say so have their edge.
void EmulatedFrontEnd::convert(std::uint64_t index) {
  settings_.samples(index, codes_);
  const auto channels = static_cast<std::size_t>(settings_.chip->channels);
  for (std::size_t chip = 0; chip < chips_.size(); ++chip) {
    chips_[chip]->convert(std::span(codes_).subspan(chip * channels, channels));
  }
  if (impostor_) {
    const std::vector<std::int32_t> zeros(256);
    impostor_->convert(zeros);
  }
  if (!settings_.chip->data_ready || !reset_high_) return;
  if (lasting(FrontEndFaultKind::edges_stuck) != nullptr || count_down(FrontEndFaultKind::edges_missed)) return;
  const bool queued = !count_down(FrontEndFaultKind::edges_unqueued);
  edge(now_ns_, queued);
  const FrontEndFault* const doubled = lasting(FrontEndFaultKind::edges_doubled);
  if (doubled == nullptr) return;
  const std::int64_t behind_ns = doubled->value;
  static_cast<void>(count_down(FrontEndFaultKind::edges_doubled));
  edge(now_ns_ + behind_ns, true);
}

void EmulatedFrontEnd::edge(std::int64_t t_ns, bool queued) {
  ++edges_counted_;
  if (!queued || edges_.size() >= settings_.kernel_edges) return;
  edges_.push_back({t_ns, settings_.counted_edges ? std::optional(edges_counted_) : std::nullopt});
}

/// Whether such a fault is under way that has times left; one is then gone.
bool EmulatedFrontEnd::count_down(FrontEndFaultKind kind) noexcept {
  const auto found =
      std::find_if(under_way_.begin(), under_way_.end(), [&](const FrontEndFault& each) { return each.kind == kind; });
  if (found == under_way_.end()) return false;
  if (--found->count == 0) under_way_.erase(found);
  return true;
}

const FrontEndFault* EmulatedFrontEnd::lasting(FrontEndFaultKind kind) const noexcept {
  const auto found =
      std::find_if(under_way_.begin(), under_way_.end(), [&](const FrontEndFault& each) { return each.kind == kind; });
  return found == under_way_.end() ? nullptr : &*found;
}

bool EmulatedFrontEnd::present(std::int64_t now_ns) {
  advance(now_ns);
  return gone_until_ns_ == 0;
}

std::uint64_t EmulatedFrontEnd::converted(std::int64_t now_ns) {
  advance(now_ns);
  return converted_;
}

std::int64_t EmulatedFrontEnd::duration_of(std::span<const hal::SpiSegment> segments) const noexcept {
  const double clock_hz =
      settings_.front_end.clock_hz != 0 ? settings_.front_end.clock_hz : settings_.chip->spi.clock_hz;
  double ns = 0.0;
  for (const hal::SpiSegment& each : segments) {
    ns += static_cast<double>(each.bytes() * bits_of_byte) / clock_hz * 1e9 + 1e3 * each.pause_us;
  }
  if (const FrontEndFault* slow = lasting(FrontEndFaultKind::slow_bus)) ns += static_cast<double>(slow->value);
  return static_cast<std::int64_t>(ns);
}

/// What is wrong in this exchange of so many bytes; what is wrong once is then over.
BusFaults EmulatedFrontEnd::faults_of(std::size_t bytes) {
  BusFaults wrong;
  const auto at = [&](FrontEndFaultKind kind) -> std::optional<std::size_t> {
    const FrontEndFault* const fault = of_this_exchange(kind);
    if (fault == nullptr) return std::nullopt;
    const auto clock = static_cast<std::size_t>(fault->value) % std::max<std::size_t>(bits_of_byte * bytes, 1);
    static_cast<void>(count_down(kind));
    return clock;
  };
  wrong.select_glitch = at(FrontEndFaultKind::select_glitch);
  wrong.lost_clock = at(FrontEndFaultKind::clock_lost);
  wrong.doubled_clock = at(FrontEndFaultKind::clock_doubled);
  wrong.turned_bit = at(FrontEndFaultKind::bit_error);
  if (const FrontEndFault* brown = of_this_exchange(FrontEndFaultKind::brown_out)) {
    wrong.chip = static_cast<std::size_t>(brown->value & 0xff);
    wrong.brown_out = static_cast<std::size_t>(brown->value >> 8);
    if (*wrong.brown_out < bytes) static_cast<void>(count_down(FrontEndFaultKind::brown_out));
  }
  if (lasting(FrontEndFaultKind::miso_low) != nullptr) wrong.stuck = false;
  if (lasting(FrontEndFaultKind::miso_high) != nullptr) wrong.stuck = true;
  return wrong;
}

const FrontEndFault* EmulatedFrontEnd::of_this_exchange(FrontEndFaultKind kind) const noexcept {
  const FrontEndFault* const fault = lasting(kind);
  const bool here = fault != nullptr && (fault->chip < 0 || static_cast<std::uint32_t>(fault->chip) == selected_);
  return here ? fault : nullptr;
}

EmulatedFrontEnd::Outcome EmulatedFrontEnd::exchange(std::span<const hal::SpiSegment> segments, std::int64_t now_ns) {
  advance(now_ns);
  if (gone_until_ns_ != 0) return Outcome::gone;
  if (count_down(FrontEndFaultKind::bus_error)) return Outcome::failed;
  if (!settings_.chip->data_ready && selected_ == 0) {
    converted_ = static_cast<std::uint64_t>(static_cast<double>(now_ns - host_origin_ns_) / period_ns());
    convert(converted_);
  }
  std::size_t bytes = 0, clocks = 0;
  for (const hal::SpiSegment& each : segments) bytes += each.bytes();
  clocked_->exchange(segments, selected_, faults_of(bytes), clocks);
  static_cast<void>(count_down(FrontEndFaultKind::slow_bus));
  return count_down(FrontEndFaultKind::answer_lost) ? Outcome::failed : Outcome::done;
}

EmulatedFrontEnd::Outcome EmulatedFrontEnd::exchange_settings(std::span<const hal::SpiSegment> segments,
                                                              std::int64_t now_ns) {
  advance(now_ns);
  if (gone_until_ns_ != 0) return Outcome::gone;
  clocked_->exchange_settings(segments);
  return Outcome::done;
}

void EmulatedFrontEnd::reset_level(bool high, std::int64_t now_ns) {
  advance(now_ns);
  if (high && !reset_high_) {
    for (auto& chip : chips_) chip->reset_pin();
    next_ns_ = static_cast<double>(now_ns) + period_ns();
    std::erase_if(under_way_, [](const FrontEndFault& each) {
      return each.kind == FrontEndFaultKind::edges_stuck && each.duration_ns == 0;
    });
  }
  reset_high_ = high;
}

void EmulatedFrontEnd::clear_edges() noexcept {
  edges_.clear();
  edges_counted_ = 0;
}

std::optional<hal::Edge> EmulatedFrontEnd::take_edge(std::int64_t now_ns) {
  advance(now_ns);
  if (edges_.empty() || edges_.front().t_ns > now_ns) return std::nullopt;
  const hal::Edge edge = edges_.front();
  edges_.erase(edges_.begin());
  return edge;
}

std::int64_t EmulatedFrontEnd::next_edge_ns(std::int64_t now_ns) {
  advance(now_ns);
  std::int64_t next_ns = static_cast<std::int64_t>(next_ns_);
  if (!edges_.empty()) next_ns = std::min(next_ns, edges_.front().t_ns);
  if (lasting(FrontEndFaultKind::edge_storm) != nullptr) next_ns = std::min(next_ns, storm_next_ns_);
  for (const FrontEndFault& each : waiting_) next_ns = std::min(next_ns, each.at_ns);
  return std::max(next_ns, now_ns + 1);
}

}  // namespace compueye::frontend
