#include "firmware/files/npy.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/npy_header.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

tl::unexpected<hal::Error> truncated(const std::string& path, std::string_view part, std::uint64_t expected,
                                     std::uint64_t actual) {
  return hal::fail(ErrorCode::bad_format, path,
                   "is truncated: its " + std::string(part) + " should have " + std::to_string(expected) +
                       " bytes, but only " + std::to_string(actual) + " are there");
}

// Fills `into` whole or says what is missing.
Result<void> read_exactly(const FileDescriptor& file, const std::string& path, std::string_view part,
                          std::span<char> into) {
  const std::size_t got = TRY(read_some(file, path, std::as_writable_bytes(into)));
  if (got != into.size()) return truncated(path, part, into.size(), got);
  return {};
}

struct Opened {
  NpyHeader header;
  std::uint64_t data_offset = 0;
};

Result<Opened> read_header(const FileDescriptor& file, const std::string& path) {
  char preamble[npy_preamble_v2_bytes];
  const auto first = std::as_writable_bytes(std::span(preamble, npy_preamble_v1_bytes));
  const std::size_t got = TRY(read_some(file, path, first));
  if (got < 6 || std::memcmp(preamble, "\x93NUMPY", 6) != 0) {
    return hal::fail(ErrorCode::bad_format, path,
                     got == 0 ? "is an empty file, expected a NumPy .npy file"
                              : "is not a NumPy .npy file, expected one that begins with \\x93NUMPY");
  }
  if (got < npy_preamble_v1_bytes) return truncated(path, "header", npy_preamble_v1_bytes, got);
  const int major = static_cast<unsigned char>(preamble[6]), minor = static_cast<unsigned char>(preamble[7]);
  if (major < 1 || major > 3 || minor != 0) {
    return hal::fail(
        ErrorCode::unsupported, path,
        "is .npy version " + std::to_string(major) + "." + std::to_string(minor) + ", expected 1.0, 2.0 or 3.0");
  }
  const std::size_t preamble_bytes = major == 1 ? npy_preamble_v1_bytes : npy_preamble_v2_bytes;
  if (major > 1) TRY(read_exactly(file, path, "header", std::span(preamble + npy_preamble_v1_bytes, 2)));
  std::uint32_t length = 0;
  std::memcpy(&length, preamble + 8, preamble_bytes - 8);
  // Plain arrays need some hundred bytes; NumPy itself refuses more than 10,000.
  if (length > 65535) {
    return hal::fail(ErrorCode::bad_format, path,
                     "announces a header of " + std::to_string(length) + " bytes, expected at most 65535");
  }
  std::string text(length, '\0');
  TRY(read_exactly(file, path, "header", text));
  return Opened{TRY(parse_npy_header(path, text)), preamble_bytes + length};
}

Result<std::uint64_t> checked_count(const std::string& path, const NpyHeader& header) {
  std::uint64_t count = 1;
  for (const std::int64_t length : header.shape) {
    if (length == 0) {
      return hal::fail(ErrorCode::out_of_range, path,
                       "is empty: its shape is " + shape_text(header.shape) + ", expected no dimension of length 0");
    }
    if (__builtin_mul_overflow(count, static_cast<std::uint64_t>(length), &count) ||
        count > static_cast<std::uint64_t>(std::numeric_limits<std::ptrdiff_t>::max()) / sizeof(double)) {
      return hal::fail(ErrorCode::bad_format, path,
                       "has the impossible shape " + shape_text(header.shape) + ", expected one that fits in memory");
    }
  }
  return count;
}

Result<void> check_dims(const std::string& path, const NpyHeader& header, int min_dims, int max_dims) {
  const int dims = static_cast<int>(header.shape.size());
  if (dims >= min_dims && dims <= max_dims) return {};
  const std::string range =
      min_dims == max_dims ? std::to_string(min_dims) : std::to_string(min_dims) + " to " + std::to_string(max_dims);
  return hal::fail(
      ErrorCode::mismatch, path,
      "has " + std::to_string(dims) + " dimensions, shape " + shape_text(header.shape) + ", expected " + range);
}

/// Where the element that stands `at` in a file of Fortran order has its place in C order.
std::size_t in_c_order(std::span<const std::int64_t> shape, std::size_t at) {
  std::size_t place = 0, stride = 1;
  for (const std::int64_t length : shape) stride *= static_cast<std::size_t>(length);
  for (const std::int64_t length : shape) {
    stride /= static_cast<std::size_t>(length);
    place += at % static_cast<std::size_t>(length) * stride;
    at /= static_cast<std::size_t>(length);
  }
  return place;
}

std::vector<double> in_c_order(const NpyHeader& header, std::vector<double> values) {
  if (!header.fortran) return values;
  std::vector<double> ordered(values.size());
  for (std::size_t at = 0; at < values.size(); ++at) ordered[in_c_order(header.shape, at)] = values[at];
  return ordered;
}

tl::unexpected<hal::Error> not_exact(const std::string& path, const NpyHeader& header, std::size_t at,
                                     const std::string& value) {
  const std::string expected =
      header.type->code == "b1" ? "expected 0 or 1 in an array of booleans"
                                : "expected whole numbers of at most 2^53 in magnitude, which a double holds exactly";
  return hal::fail(ErrorCode::out_of_range, path,
                   "has the value " + value + " at " +
                       index_text(header.shape, header.fortran ? in_c_order(header.shape, at) : at) + ", " + expected);
}

// In pieces, so that a file of several hundred MB is in memory once, as doubles, and a pipe that lies about its size
// costs no more than what it really sends.
Result<std::vector<double>> read_values(const FileDescriptor& file, const std::string& path, const NpyHeader& header,
                                        std::uint64_t count) {
  const std::size_t width = header.type->bytes;
  std::vector<char> piece(static_cast<std::size_t>(std::min<std::uint64_t>(count * width, 1U << 20U)));
  std::vector<double> values;
  if (regular_size(file)) values.reserve(static_cast<std::size_t>(count));
  while (values.size() < count) {
    const std::size_t want =
        static_cast<std::size_t>(std::min<std::uint64_t>(count - values.size(), piece.size() / width));
    const std::size_t got = TRY(read_some(file, path, std::as_writable_bytes(std::span(piece).first(want * width))));
    if (got != want * width) return truncated(path, "data", count * width, values.size() * width + got);
    for (std::size_t i = 0; header.big_endian && i < want; ++i) {
      std::reverse(piece.data() + i * width, piece.data() + (i + 1) * width);
    }
    if (const auto bad = header.type->append(piece.data(), want, values)) {
      return not_exact(path, header, values.size(), *bad);
    }
  }
  std::byte extra{};
  if (TRY(read_some(file, path, std::span(&extra, 1))) != 0) {
    return hal::fail(ErrorCode::bad_format, path,
                     "goes on after its data, expected an end after the " + std::to_string(count * width) +
                         " bytes that shape " + shape_text(header.shape) + " needs");
  }
  return values;
}

template <class T>
Result<void> write_array(const std::string& path, std::string_view descr, std::span<const std::int64_t> shape,
                         std::span<const T> values) {
  std::uint64_t count = 1;
  for (const std::int64_t length : shape) {
    if (length < 0 || __builtin_mul_overflow(count, static_cast<std::uint64_t>(length), &count)) count = ~0ULL;
  }
  if (count != values.size()) {
    return hal::fail(ErrorCode::usage, path,
                     "was given " + std::to_string(values.size()) + " values for shape " + shape_text(shape));
  }
  AtomicFile file = TRY(AtomicFile::create(path));
  TRY(file.write(format_npy_header(descr, shape)));
  TRY(file.write(std::as_bytes(values)));
  return file.commit();
}

// Rows, columns, channels and frames are ints everywhere behind this door.
Result<NpyArray> read_with_int_lengths(const std::string& path, int min_dims, int max_dims, std::string_view expected) {
  NpyArray array = TRY(read_npy(path, 1, 32));
  const int dims = static_cast<int>(array.shape.size());
  const bool fits = std::all_of(array.shape.begin(), array.shape.end(),
                                [](std::int64_t n) { return n <= std::numeric_limits<int>::max(); });
  if (dims < min_dims || dims > max_dims || !fits) {
    return hal::fail(ErrorCode::mismatch, path,
                     "has shape " + shape_text(array.shape) + ", expected " + std::string(expected));
  }
  return array;
}

}  // namespace

Result<NpyArray> read_npy(const std::string& path, int min_dims, int max_dims) {
  const FileDescriptor file = TRY(open_for_reading(path));
  auto [header, data_offset] = TRY(read_header(file, path));
  TRY(check_dims(path, header, min_dims, max_dims));
  const std::uint64_t count = TRY(checked_count(path, header));
  if (const auto size = regular_size(file)) {
    const std::uint64_t expected = count * header.type->bytes, actual = *size - std::min(*size, data_offset);
    if (actual < expected) return truncated(path, "data", expected, actual);
  }
  std::vector<double> values = in_c_order(header, TRY(read_values(file, path, header, count)));
  return NpyArray{std::move(header.shape), std::move(values)};
}

Result<NpyArray> read_matrix(const std::string& path) {
  return read_with_int_lengths(path, 2, 2, "a matrix of shape (rows, columns)");
}

Result<SampleArray> read_samples(const std::string& path, std::int64_t channels) {
  NpyArray array = TRY(read_with_int_lengths(path, 1, 2, "samples of shape (M,) or (frames, M)"));
  if (array.shape == std::vector<std::int64_t>{channels, 1}) array.shape.pop_back();
  const bool framed = array.shape.size() == 2;
  return SampleArray{framed ? array.shape[0] : 1, array.shape.back(), framed, std::move(array.values)};
}

Result<PictureArray> read_pictures(const std::string& path) {
  NpyArray array = TRY(read_with_int_lengths(path, 2, 3, "pictures of shape (H, W) or (frames, H, W)"));
  const bool framed = array.shape.size() == 3;
  const std::size_t first = framed ? 1 : 0;
  return PictureArray{framed ? array.shape[0] : 1, array.shape[first], array.shape[first + 1], framed,
                      std::move(array.values)};
}

std::optional<std::size_t> first_non_finite(std::span<const double> values) noexcept {
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (bad == values.end()) return std::nullopt;
  return static_cast<std::size_t>(bad - values.begin());
}

std::string index_text(std::span<const std::int64_t> shape, std::size_t flat) {
  std::vector<std::int64_t> index(shape.size());
  for (std::size_t d = shape.size(); d-- > 0;) {
    const auto length = static_cast<std::size_t>(std::max<std::int64_t>(shape[d], 1));
    index[d] = static_cast<std::int64_t>(flat % length);
    flat /= length;
  }
  std::string text = shape_text(index);
  if (index.size() == 1) text.erase(text.size() - 2, 1);
  return text;
}

Result<void> write_npy(const std::string& path, std::span<const std::int64_t> shape, std::span<const float> values) {
  return write_array(path, "<f4", shape, values);
}

Result<void> write_npy(const std::string& path, std::span<const std::int64_t> shape, std::span<const double> values) {
  return write_array(path, "<f8", shape, values);
}

}  // namespace compueye::firmware
