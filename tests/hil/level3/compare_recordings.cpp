// Whether every frame of a recording is, code by code, one of another recording: the one with its number, or with
// --in-order the next one or the same again that is alike, for sources that count frames from another start.

#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "hal/try.hpp"

namespace compueye::hil {
namespace {

struct Frame {
  std::uint64_t number = 0;
  std::vector<std::int32_t> codes;
  bool whole = true;
};

hal::Result<std::vector<Frame>> frames_of(const std::string& path) {
  auto reader = TRY(recording::RecordingReader::open(path));
  std::vector<Frame> frames;
  for (;;) {
    const auto next = reader.next();
    if (!next && next.error().code == hal::ErrorCode::end_of_stream) return frames;
    if (!next) return tl::unexpected(next.error());
    Frame frame{next->block.frame, {next->block.codes.begin(), next->block.codes.end()}, true};
    for (const std::uint8_t valid : next->block.valid) frame.whole = frame.whole && valid != 0;
    frames.push_back(std::move(frame));
  }
}

struct Comparison {
  std::size_t same = 0, other = 0, partial = 0;
};

Comparison compare(const std::vector<Frame>& frames, const std::vector<Frame>& reference, bool in_order) {
  Comparison result;
  std::size_t at = 0;
  for (const Frame& frame : frames) {
    if (!frame.whole) {
      ++result.partial;
      continue;
    }
    std::size_t found = at;
    while (found < reference.size() &&
           (in_order ? reference[found].codes != frame.codes : reference[found].number != frame.number)) {
      ++found;
    }
    const bool same = found < reference.size() && reference[found].codes == frame.codes;
    ++(same ? result.same : result.other);
    if (same) at = found;  // a source that samples when asked may see one conversion twice
  }
  return result;
}

hal::Result<bool> run(const std::string& path, const std::string& reference, bool in_order) {
  const std::vector<Frame> frames = TRY(frames_of(path));
  const Comparison found = compare(frames, TRY(frames_of(reference)), in_order);
  std::cout << found.same << " frames the same, " << found.other << " others, " << found.partial << " not whole\n";
  return found.same > 0 && found.other == 0;
}

}  // namespace
}  // namespace compueye::hil

int main(int argc, char** argv) {
  const bool in_order = argc == 4 && std::string(argv[1]) == "--in-order";
  if (argc != 3 && !in_order) {
    std::cerr << "usage: compare_recordings [--in-order] RECORDING REFERENCE\n";
    return 2;
  }
  const auto same = compueye::hil::run(argv[argc - 2], argv[argc - 1], in_order);
  if (!same) std::cerr << "compare_recordings: " << same.error().text() << "\n";
  return same && *same ? 0 : 1;
}
