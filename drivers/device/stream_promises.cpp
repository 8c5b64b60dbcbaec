#include "drivers/device/stream_promises.hpp"

#include <algorithm>

#include "drivers/protocol/packet_encoder.hpp"

namespace compueye::device {
namespace {

using namespace protocol;

constexpr std::array<std::string_view, 10> names{
    "packets are whole, one after the other",   "every packet has the next number, from 0",
    "every packet carries the configuration",   "frames count from 0, what was dropped is told",
    "a frame has every channel once, in order", "codes lie within their depth",
    "SAT stands where a code is at full scale", "OVERRUN stands behind dropped frames alone",
    "times grow by the frame period",           "events and logs are marked as such",
};

std::string number_text(std::uint64_t value) {
  return std::to_string(value);
}

}  // namespace

std::string_view name(ConformanceRow::Verdict verdict) noexcept {
  constexpr std::array<std::string_view, 3> words{"pass", "fail", "skipped"};
  return words[static_cast<std::size_t>(verdict)];
}

StreamPromises::StreamPromises(const Bus& bus, const DeviceDescriptor& eye, const Configuration& configuration)
    : bus_(bus),
      eye_(eye),
      configuration_(configuration),
      stream_(eye.packet_limits()),
      values_(static_cast<std::size_t>(eye.channels)),
      valid_(static_cast<std::size_t>(eye.channels)) {}

void StreamPromises::hold(Promise promise, bool kept, const std::string& otherwise) {
  Evidence& evidence = evidence_[promise];
  ++evidence.seen;
  if (!kept && evidence.broken.empty()) evidence.broken = otherwise;
}

void StreamPromises::feed(std::span<const std::byte> bytes) {
  if (bus_.framing == Framing::reports) return judge(bytes);
  stream_.feed(bytes);
  while (const auto packet = stream_.next()) judge(*packet);
  const StreamCounters& c = stream_.counters();
  hold(whole, c.skipped_bytes == 0 && c.crc_errors == 0 && c.bad_headers == 0,
       "after " + number_text(c.packets) + " packets: " + number_text(c.skipped_bytes) + " bytes of none, " +
           number_text(c.crc_errors) + " wrong CRCs, " + number_text(c.bad_headers) + " headers that make no sense");
}

void StreamPromises::judge(const Packet& packet) {
  const FrameHeader& h = packet.header;
  const std::string at = "packet " + number_text(h.seq) + " of frame " + number_text(h.frame);
  hold(numbered, h.seq == static_cast<std::uint32_t>(next_seq_),
       "seq is " + number_text(h.seq) + ", expected " + number_text(next_seq_));
  next_seq_ = std::uint64_t{h.seq} + 1;
  hold(configured, h.config_id == configuration_.config_id && h.version == eye_.version,
       at + " has config_id " + number_text(h.config_id) + " and version byte " + number_text(h.version.byte()) +
           ", expected " + number_text(configuration_.config_id) + " and " + number_text(eye_.version.byte()));
  h.type == PacketType::data ? judge_data(packet) : judge_other(packet);
}

void StreamPromises::begin_frame(std::uint64_t frame, bool marked, std::optional<std::uint64_t> dropped) {
  const std::uint64_t expected = frame_ ? *frame_ + 1 : 0;
  hold(framed, frame >= expected, "frame " + number_text(frame) + " came where " + number_text(expected) + " was next");
  const std::uint64_t gap = frame - std::min(frame, expected);
  after_gap_ = gap > 0;
  gaps_ += after_gap_ ? 1 : 0;
  if (dropped) {
    const std::uint64_t grew = (*dropped - dropped_) & 0xFFFFU;
    hold(framed, grew == (gap & 0xFFFFU),
         "before frame " + number_text(frame) + " " + number_text(gap) + " are missing, and dropped grew by " +
             number_text(grew));
    dropped_ = *dropped;
  } else {
    hold(framed, !after_gap_ || marked,
         number_text(gap) + " frames are missing before frame " + number_text(frame) + ", which has no OVERRUN");
  }
  frame_ = frame;
  ++frames_;
  next_part_ = 0;
}

void StreamPromises::judge_data(const Packet& packet) {
  const FrameHeader& h = packet.header;
  const auto channels = static_cast<std::size_t>(eye_.channels);
  const std::string at = "frame " + number_text(h.frame) + ": ";
  if (!frame_ || static_cast<std::uint32_t>(*frame_) != h.frame) {
    hold(parts, !frame_ || next_part_ == channels,
         "frame " + number_text(frame_.value_or(0)) + " ended after " + number_text(next_part_) + " of " +
             number_text(channels) + " channels");
    begin_frame(h.frame, h.has(packet_flag::overrun), h.dropped);
    judge_time(h.frame, h.t_ns, h.has(packet_flag::time_ok));
    frame_t_ns_ = h.t_ns;
  }
  hold(overrun, h.has(packet_flag::overrun) == after_gap_,
       at + (after_gap_ ? "OVERRUN is missing behind dropped frames" : "OVERRUN, and nothing was dropped before it"));
  const bool first = next_part_ == 0, last = std::size_t{h.first_ch} + h.n_ch == channels;
  hold(parts, h.first_ch == next_part_ && h.t_ns == frame_t_ns_,
       at + "channel " + number_text(h.first_ch) + " came where " + number_text(next_part_) +
           " was next, or t_ns changed");
  hold(parts, h.has(packet_flag::sof) == first && h.has(packet_flag::eof) == last,
       at + "SOF or EOF is not on the first or last packet");
  next_part_ = std::size_t{h.first_ch} + h.n_ch;
  hold(configured, h.format == configuration_.format, at + "has another format than was configured");
  judge_codes(h.format, packet.payload, h.n_ch, h.has(packet_flag::sat));
  illum_ = h.illum;
  dark_ = h.has(packet_flag::dark);
  hold(others, !dark_ || !eye_.illuminators.empty(), at + "DARK, and the eye has no illuminators");
}

void StreamPromises::judge_other(const Packet& packet) {
  const FrameHeader& h = packet.header;
  const std::string at = "packet " + number_text(h.seq) + ": ";
  hold(others, (h.flags & ~packet_flag::time_ok) == 0 && h.first_ch == 0 && h.n_ch == 0,
       at + "flags " + number_text(h.flags) + " and channels, expected at most TIME_OK and none");
  const bool fits = h.type == PacketType::event ? packet.payload.size() >= EventPayload::bytes
                                                : h.type != PacketType::log || packet.payload.size() <= 255;
  hold(others, fits, at + "a payload of " + number_text(packet.payload.size()) + " bytes");
}

void StreamPromises::judge_codes(SampleFormat format, std::span<const std::byte> payload, std::size_t count, bool sat) {
  count = std::min(count, values_.size());
  const auto into = std::span(values_).first(count);
  const std::size_t within = unpack(format, payload, eye_.bits, into, std::span(valid_).first(count));
  const std::string at = "frame " + number_text(frame_.value_or(0)) + ": ";
  hold(codes, within == count,
       at + "a code is beyond 2^" + number_text(static_cast<std::uint64_t>(eye_.bits)) + " - 1");
  const auto full = static_cast<std::int32_t>((1U << static_cast<unsigned>(eye_.bits)) - 1U);
  const bool at_full = std::find(into.begin(), into.end(), full) != into.end();
  hold(saturated, sat == at_full,
       at + (at_full ? "SAT is missing" : "SAT, and no code of its packet is at full scale"));
}

void StreamPromises::judge_time(std::uint64_t frame, std::uint64_t t_ns, bool time_ok) {
  if (!time_ok) {
    hold(timed, ++untrusted_ <= 1, "TIME_OK is missing again in frame " + number_text(frame));
    trusted_frame_.reset();
    return;
  }
  if (trusted_frame_) {
    const auto period = static_cast<std::uint64_t>(configuration_.period_ns());
    const std::uint64_t expected = trusted_t_ns_ + (frame - *trusted_frame_) * period;
    const std::uint64_t off = t_ns > expected ? t_ns - expected : expected - t_ns;
    hold(timed, off <= period / 4 + (frame - *trusted_frame_) * period / 50,
         "frame " + number_text(frame) + " is " + number_text(off) + " ns off the period of " + number_text(period));
  }
  trusted_frame_ = frame;
  trusted_t_ns_ = t_ns;
}

void StreamPromises::judge(std::span<const std::byte> report) {
  const ParsedHidReport parsed = parse_hid_report(report);
  constexpr std::array<std::string_view, 5> faults{"", "is not of 64 bytes", "has another id than 1", "has a wrong CRC",
                                                   "has a part beyond its parts"};
  hold(whole, parsed.fault == HidFault::none,
       "a report " + std::string(faults[static_cast<std::size_t>(parsed.fault)]));
  if (parsed.fault != HidFault::none) return;
  const HidReport& r = parsed.report;
  const auto all_parts = static_cast<std::size_t>(hid_parts(eye_.channels));
  const std::string at = "frame " + number_text(r.frame) + ": ";
  hold(configured, r.config_tag() == configuration_.config_id % 16,
       at + "tag " + number_text(r.config_tag()) + ", expected " + number_text(configuration_.config_id % 16));
  if (!frame_ || static_cast<std::uint16_t>(*frame_) != r.frame) {
    hold(parts, !frame_ || next_part_ == all_parts,
         "frame " + number_text(frame_.value_or(0)) + " ended after " + number_text(next_part_) + " of " +
             number_text(all_parts) + " parts");
    begin_frame(frame_ ? *frame_ + static_cast<std::uint16_t>(r.frame - static_cast<std::uint16_t>(*frame_)) : r.frame,
                r.has(hid_flag::overrun), std::nullopt);
    if (!r.has(hid_flag::time_ok)) hold(timed, ++untrusted_ <= 1, at + "TIME_OK is missing again");
  }
  hold(overrun, r.has(hid_flag::overrun) == after_gap_,
       at + (after_gap_ ? "OVERRUN is missing behind dropped frames" : "OVERRUN, and nothing was dropped before it"));
  hold(parts, r.part == next_part_ && r.parts == all_parts,
       at + "part " + number_text(r.part) + " of " + number_text(r.parts) + ", expected " + number_text(next_part_) +
           " of " + number_text(all_parts));
  next_part_ = std::size_t{r.part} + 1;
  const std::size_t before = std::size_t{r.part} * hid_channels_per_report;
  const std::size_t count =
      std::min<std::size_t>(hid_channels_per_report, values_.size() - std::min(values_.size(), before));
  const std::size_t used = packed_bytes(SampleFormat::u12, count);
  judge_codes(SampleFormat::u12, r.payload.first(used), count, r.has(hid_flag::sat));
  const auto rest = r.payload.subspan(used);
  hold(codes, std::all_of(rest.begin(), rest.end(), [](std::byte b) { return b == std::byte{0}; }),
       at + "unused codes are not 0");
  dark_ = r.has(hid_flag::dark);
}

std::vector<ConformanceRow> StreamPromises::rows() const {
  std::vector<ConformanceRow> rows;
  for (std::size_t p = 0; p < promises; ++p) {
    const Evidence& evidence = evidence_[p];
    using Verdict = ConformanceRow::Verdict;
    ConformanceRow row{std::string(names[p]), Verdict::pass, evidence.broken};
    if (!evidence.broken.empty()) {
      row.verdict = Verdict::fail;
    } else if (evidence.seen == 0) {
      row.verdict = Verdict::skipped;
      row.why = "none came that would show it";
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string StreamPromises::broken() const {
  for (std::size_t p = 0; p < promises; ++p) {
    if (!evidence_[p].broken.empty()) return std::string(names[p]) + ": " + evidence_[p].broken;
  }
  return {};
}

}  // namespace compueye::device
