#include "drivers/recording/recording_reader.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "drivers/recording/recording_format.hpp"
#include "hal/try.hpp"

namespace compueye::recording {
namespace {

constexpr std::size_t least_window = std::size_t{1} << 18U;

}  // namespace

hal::Result<RecordingReader> RecordingReader::open(const std::string& path) {
  auto bytes = TRY(stored_file(path));
  return over(std::move(bytes));
}

hal::Result<RecordingReader> RecordingReader::over(std::unique_ptr<StoredBytes> bytes) {
  RecordingReader reader;
  reader.bytes_ = std::move(bytes);
  const std::string& place = reader.bytes_->place();
  const std::uint64_t size = reader.bytes_->size();
  std::vector<std::byte> begin(static_cast<std::size_t>(std::min<std::uint64_t>(size, fixed_header_bytes)));
  TRY(reader.bytes_->read_at(0, begin));
  const auto stated = TRY(stated_header_bytes(begin, place));
  begin.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, stated)));
  TRY(reader.bytes_->read_at(0, begin));
  auto header = TRY(parse_header(begin, place));
  reader.header_ = std::move(header);
  reader.first_block_at_ = stated;
  const auto channels = static_cast<std::size_t>(reader.header_.source.channels);
  reader.frame_bytes_ = frame_block_bytes(channels, reader.header_.source.bits);
  const std::size_t wanted = std::max(least_window, 2 * reader.frame_bytes_);
  reader.buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(wanted, size)));
  reader.codes_.resize(channels);
  reader.valid_.resize(channels);
  reader.rewind();
  return reader;
}

void RecordingReader::rewind() noexcept {
  at_ = first_block_at_;
  buffer_size_ = 0;
  over_ = false;
  delivered_ = 0;
  last_frame_.reset();
  last_ = {};
  damage_ = {};
  end_.reset();
}

/// `count` bytes, which lie within the file and are at most a frame block.
hal::Result<std::span<const std::byte>> RecordingReader::window(std::uint64_t offset, std::size_t count) {
  if (offset < buffer_at_ || offset + count > buffer_at_ + buffer_size_) {
    buffer_at_ = offset;
    buffer_size_ = 0;
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(buffer_.size(), bytes_->size() - offset));
    TRY(bytes_->read_at(offset, std::span(buffer_).first(size)));
    buffer_size_ = size;
  }
  return std::span<const std::byte>(buffer_).subspan(static_cast<std::size_t>(offset - buffer_at_), count);
}

/// The whole, right block that begins at `offset`, if there is one.
hal::Result<std::optional<RecordingReader::Found>> RecordingReader::block_at(std::uint64_t offset) {
  if (bytes_->size() - offset < end_block_bytes) return std::nullopt;
  const auto head_bytes = TRY(window(offset, block_head_bytes));
  const auto head = decode_head(head_bytes.first<block_head_bytes>(), frame_bytes_);
  if (!head || !follows(*head, last_, last_frame_)) return std::nullopt;
  const std::size_t length = head->kind == BlockKind::frame ? frame_bytes_ : end_block_bytes;
  if (bytes_->size() - offset < length) return std::nullopt;
  const auto bytes = TRY(window(offset, length));
  if (!sealed(bytes)) return std::nullopt;
  if (head->kind == BlockKind::frame && !decode_samples(bytes, header_.source.bits, codes_, valid_)) {
    return std::nullopt;
  }
  return Found{*head, bytes};
}

/// Offset >= `offset` of the next piece of a block's magic number, which may be cut by the end; the end if there is
/// none.
hal::Result<std::uint64_t> RecordingReader::next_candidate(std::uint64_t offset) {
  while (offset < bytes_->size()) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(frame_bytes_, bytes_->size() - offset));
    const auto piece = TRY(window(offset, count));
    for (std::size_t k = 0; k < count; ++k) {
      const void* const found = std::memchr(piece.data() + k, block_magic[0], count - k);
      if (found == nullptr) break;
      k = static_cast<std::size_t>(static_cast<const std::byte*>(found) - piece.data());
      const std::size_t known = std::min(block_magic.size(), count - k);
      if (std::memcmp(piece.data() + k, block_magic.data(), known) != 0) continue;
      if (known == block_magic.size() || offset + count == bytes_->size()) return offset + k;
    }
    // Cut by the piece's end, not by the file's: look at its last bytes again.
    offset += offset + count == bytes_->size() ? count : count - (block_magic.size() - 1);
  }
  return bytes_->size();
}

void RecordingReader::note_damage(std::uint64_t from, std::uint64_t to) noexcept {
  if (from == to) return;
  if (damage_.stretches++ == 0) damage_.first_at = from;
  damage_.bytes += to - from;
}

/// Whether the rest of the file from `offset` is the beginning of a block.
hal::Result<bool> RecordingReader::begins_block(std::uint64_t offset) {
  const std::uint64_t rest = bytes_->size() - offset;
  // Its magic number, or what there is of it, was seen; behind damage a byte or two of that prove nothing.
  if (rest < block_head_bytes) return offset == at_ || rest >= block_magic.size();
  const auto bytes = TRY(window(offset, block_head_bytes));
  const auto head = decode_head(bytes.first<block_head_bytes>(), frame_bytes_);
  return head && follows(*head, last_, last_frame_) &&
         rest < (head->kind == BlockKind::frame ? frame_bytes_ : end_block_bytes);
}

/// What lies behind the last whole block: damage, then perhaps a block that was begun and not finished.
hal::Result<void> RecordingReader::note_tail(std::uint64_t from) {
  std::uint64_t torn_at = bytes_->size();
  // A block that was begun is shorter than one, so it cannot lie further from the end.
  std::uint64_t look = std::max(from, bytes_->size() - std::min<std::uint64_t>(bytes_->size(), frame_bytes_));
  while (look < bytes_->size()) {
    const auto candidate = TRY(next_candidate(look));
    if (candidate == bytes_->size()) break;
    const auto begun = TRY(begins_block(candidate));
    if (begun) {
      torn_at = candidate;
      break;
    }
    look = candidate + 1;
  }
  note_damage(from, torn_at);
  // Where no later number tells how many they were.
  damage_.blocks += (torn_at - from) / frame_bytes_;
  damage_.torn_at = torn_at < bytes_->size() ? torn_at : 0;
  damage_.torn_bytes = bytes_->size() - torn_at;
  return {};
}

/// The next whole block, over damage if need be; nothing at the end of the file.
hal::Result<std::optional<RecordingReader::Found>> RecordingReader::next_block() {
  std::uint64_t candidate = at_;
  while (candidate < bytes_->size()) {
    auto found = TRY(block_at(candidate));
    if (found) {
      note_damage(at_, candidate);
      at_ = candidate + found->bytes.size();
      return found;
    }
    const auto next = TRY(next_candidate(candidate + 1));
    candidate = next;
  }
  return std::nullopt;
}

hal::Result<RecordedFrame> RecordingReader::next() {
  if (over_) return hal::stream_ended();
  const auto found = TRY(next_block());
  if (!found) {
    TRY(note_tail(at_));
    over_ = true;
    return hal::stream_ended();
  }
  const BlockHead& head = found->head;
  damage_.blocks += head.books.index - last_.index;
  last_ = head.books;
  if (head.kind == BlockKind::end) {
    end_ = RecordedEnd{head.ending, head.arrival_ns};
    note_damage(at_, bytes_->size());
    over_ = true;
    return hal::stream_ended();
  }
  ++last_.index;
  ++delivered_;
  last_frame_ = head.frame;
  RecordedFrame frame;
  frame.block = {codes_, valid_, header_.source.bits, head.frame, head.t_ns, head.config_id, head.flags};
  frame.arrival_ns = head.arrival_ns;
  return frame;
}

hal::FrameAccount RecordingReader::account() const noexcept {
  hal::FrameAccount account;
  account.delivered = delivered_;
  std::copy(last_.dropped.begin(), last_.dropped.end(), account.dropped.begin());
  account.estimated = std::min(last_.estimated, account.total_dropped());
  account.drops(hal::DropReason::transport_gap) += last_.unrecorded;
  account.drops(hal::DropReason::corrupt) += damage_.blocks;
  const std::uint64_t numbered = last_frame_ ? *last_frame_ + 1 : 0;
  const std::uint64_t known = delivered_ + account.total_dropped();
  if (numbered > known) account.drops(hal::DropReason::transport_gap) += numbered - known;
  account.produced = account.delivered + account.total_dropped();
  return account;
}

}  // namespace compueye::recording
