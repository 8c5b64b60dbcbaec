#include "firmware/files/npy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/npy_header.hpp"

namespace compueye::firmware {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied from and to little-endian files");

using hal::ErrorCode;
using hal::Result;

tl::unexpected<hal::Error> truncated(const std::filesystem::path& path, std::string_view part, std::uint64_t expected,
                                     std::uint64_t actual) {
  return hal::fail(ErrorCode::bad_format, path.string(),
                   "is truncated: its " + std::string(part) + " should have " + std::to_string(expected) +
                       " bytes, but only " + std::to_string(actual) + " are there");
}

// Fills `into` whole or says what is missing.
Result<void> read_exactly(const FileDescriptor& file, const std::filesystem::path& path, std::string_view part,
                          std::span<char> into) {
  auto got = read_some(file, path, std::as_writable_bytes(into));
  if (!got) return tl::unexpected(std::move(got.error()));
  if (*got != into.size()) return truncated(path, part, into.size(), *got);
  return {};
}

struct Opened {
  NpyHeader header;
  std::uint64_t data_offset = 0;
};

Result<Opened> read_header(const FileDescriptor& file, const std::filesystem::path& path) {
  char preamble[npy_preamble_v2_bytes];
  auto got = read_some(file, path, std::as_writable_bytes(std::span(preamble, npy_preamble_v1_bytes)));
  if (!got) return tl::unexpected(std::move(got.error()));
  if (*got < 6 || std::memcmp(preamble, "\x93NUMPY", 6) != 0) {
    return hal::fail(ErrorCode::bad_format, path.string(),
                     *got == 0 ? "is an empty file, expected a NumPy .npy file"
                               : "is not a NumPy .npy file, expected one that begins with \\x93NUMPY");
  }
  if (*got < npy_preamble_v1_bytes) return truncated(path, "header", npy_preamble_v1_bytes, *got);
  const int major = static_cast<unsigned char>(preamble[6]), minor = static_cast<unsigned char>(preamble[7]);
  if (major < 1 || major > 3 || minor != 0) {
    return hal::fail(
        ErrorCode::unsupported, path.string(),
        "is .npy version " + std::to_string(major) + "." + std::to_string(minor) + ", expected 1.0, 2.0 or 3.0");
  }
  const std::size_t preamble_bytes = major == 1 ? npy_preamble_v1_bytes : npy_preamble_v2_bytes;
  if (major > 1) {
    auto ok = read_exactly(file, path, "header", std::span(preamble + npy_preamble_v1_bytes, 2));
    if (!ok) return tl::unexpected(std::move(ok.error()));
  }
  std::uint32_t length = 0;
  std::memcpy(&length, preamble + 8, preamble_bytes - 8);
  // Plain arrays need some hundred bytes; NumPy itself refuses more than 10,000.
  if (length > 65535) {
    return hal::fail(ErrorCode::bad_format, path.string(),
                     "announces a header of " + std::to_string(length) + " bytes, expected at most 65535");
  }
  std::string text(length, '\0');
  if (auto ok = read_exactly(file, path, "header", text); !ok) return tl::unexpected(std::move(ok.error()));
  auto header = parse_npy_header(path, text);
  if (!header) return tl::unexpected(std::move(header.error()));
  return Opened{std::move(*header), preamble_bytes + length};
}

Result<std::uint64_t> checked_count(const std::filesystem::path& path, const NpyHeader& header) {
  std::uint64_t count = 1;
  for (const std::int64_t length : header.shape) {
    if (length == 0) {
      return hal::fail(ErrorCode::out_of_range, path.string(),
                       "is empty: its shape is " + shape_text(header.shape) + ", expected no dimension of length 0");
    }
    if (__builtin_mul_overflow(count, static_cast<std::uint64_t>(length), &count) ||
        count > static_cast<std::uint64_t>(std::numeric_limits<std::ptrdiff_t>::max()) / sizeof(double)) {
      return hal::fail(ErrorCode::bad_format, path.string(),
                       "has the impossible shape " + shape_text(header.shape) + ", expected one that fits in memory");
    }
  }
  return count;
}

Result<void> check_dims(const std::filesystem::path& path, const NpyHeader& header, int min_dims, int max_dims) {
  const int dims = static_cast<int>(header.shape.size());
  if (dims >= min_dims && dims <= max_dims) return {};
  const std::string range =
      min_dims == max_dims ? std::to_string(min_dims) : std::to_string(min_dims) + " to " + std::to_string(max_dims);
  return hal::fail(
      ErrorCode::mismatch, path.string(),
      "has " + std::to_string(dims) + " dimensions, shape " + shape_text(header.shape) + ", expected " + range);
}

double half_to_double(std::uint16_t bits) {
  const int exponent = (bits >> 10U) & 0x1F;
  const int fraction = bits & 0x3FF;
  const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
  if (exponent == 0x1F) {
    return sign * (fraction != 0 ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity());
  }
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(fraction + 1024, exponent - 25));
}

template <class T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

// Appends `count` elements as doubles; returns the text of the first that a double or a bool cannot hold, or nothing.
template <class T>
std::optional<std::string> append(const char* from, std::size_t count, std::vector<double>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const T value = load<T>(from + i * sizeof(T));
    if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
      constexpr T exact = T{1} << 53;
      bool holds = value <= exact;
      if constexpr (std::is_signed_v<T>) holds = holds && value >= -exact;
      if (!holds) return std::to_string(value);
    }
    out.push_back(static_cast<double>(value));
  }
  return std::nullopt;
}

std::optional<std::string> append_as(NpyType type, const char* from, std::size_t count, std::vector<double>& out) {
  switch (type) {
    case NpyType::f2:
      for (std::size_t i = 0; i < count; ++i) out.push_back(half_to_double(load<std::uint16_t>(from + 2 * i)));
      return std::nullopt;
    case NpyType::f4:
      return append<float>(from, count, out);
    case NpyType::f8:
      return append<double>(from, count, out);
    case NpyType::i1:
      return append<std::int8_t>(from, count, out);
    case NpyType::i2:
      return append<std::int16_t>(from, count, out);
    case NpyType::i4:
      return append<std::int32_t>(from, count, out);
    case NpyType::i8:
      return append<std::int64_t>(from, count, out);
    case NpyType::u2:
      return append<std::uint16_t>(from, count, out);
    case NpyType::u4:
      return append<std::uint32_t>(from, count, out);
    case NpyType::u8:
      return append<std::uint64_t>(from, count, out);
    case NpyType::u1:
      return append<std::uint8_t>(from, count, out);
    case NpyType::b1:
      for (std::size_t i = 0; i < count; ++i) {
        const auto value = static_cast<unsigned char>(from[i]);
        if (value > 1) return std::to_string(value);
        out.push_back(value);
      }
      return std::nullopt;
  }
  return std::nullopt;
}

tl::unexpected<hal::Error> not_exact(const std::filesystem::path& path, const NpyHeader& header, std::size_t at,
                                     const std::string& value) {
  const std::string expected =
      header.type == NpyType::b1 ? "expected 0 or 1 in an array of booleans"
                                 : "expected whole numbers of at most 2^53 in magnitude, which a double holds exactly";
  return hal::fail(ErrorCode::out_of_range, path.string(),
                   "has the value " + value + " at " + index_text(header.shape, at) + ", " + expected);
}

// In pieces, so that a file of several hundred MB is in memory once, as doubles, and a pipe that lies about its size
// costs no more than what it really sends.
Result<std::vector<double>> read_values(const FileDescriptor& file, const std::filesystem::path& path,
                                        const NpyHeader& header, std::uint64_t count) {
  const std::size_t width = item_bytes(header.type);
  std::vector<char> piece(static_cast<std::size_t>(std::min<std::uint64_t>(count * width, 1U << 20U)));
  std::vector<double> values;
  if (regular_size(file)) values.reserve(static_cast<std::size_t>(count));
  while (values.size() < count) {
    const std::size_t want =
        static_cast<std::size_t>(std::min<std::uint64_t>(count - values.size(), piece.size() / width));
    auto got = read_some(file, path, std::as_writable_bytes(std::span(piece).first(want * width)));
    if (!got) return tl::unexpected(std::move(got.error()));
    if (*got != want * width) return truncated(path, "data", count * width, values.size() * width + *got);
    if (auto bad = append_as(header.type, piece.data(), want, values)) {
      return not_exact(path, header, values.size(), *bad);
    }
  }
  std::byte extra{};
  auto got = read_some(file, path, std::span(&extra, 1));
  if (!got) return tl::unexpected(std::move(got.error()));
  if (*got != 0) {
    return hal::fail(ErrorCode::bad_format, path.string(),
                     "goes on after its data, expected an end after the " + std::to_string(count * width) +
                         " bytes that shape " + shape_text(header.shape) + " needs");
  }
  return values;
}

template <class T>
Result<void> write_array(const std::filesystem::path& path, NpyType type, std::span<const std::int64_t> shape,
                         std::span<const T> values) {
  std::uint64_t count = 1;
  for (const std::int64_t length : shape) {
    if (length < 0 || __builtin_mul_overflow(count, static_cast<std::uint64_t>(length), &count)) count = ~0ULL;
  }
  if (count != values.size()) {
    return hal::fail(ErrorCode::usage, path.string(),
                     "was given " + std::to_string(values.size()) + " values for shape " + shape_text(shape));
  }
  auto file = AtomicFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  return file->write(format_npy_header(type, shape))
      .and_then([&] { return file->write(std::as_bytes(values)); })
      .and_then([&] { return file->commit(); });
}

// Rows, columns, channels and frames are ints everywhere behind this door.
Result<NpyArray> read_with_int_lengths(const std::filesystem::path& path, int min_dims, int max_dims,
                                       std::string_view expected) {
  auto array = read_npy(path, 1, 32);
  if (!array) return array;
  const int dims = static_cast<int>(array->shape.size());
  const bool fits = std::all_of(array->shape.begin(), array->shape.end(),
                                [](std::int64_t n) { return n <= std::numeric_limits<int>::max(); });
  if (dims < min_dims || dims > max_dims || !fits) {
    return hal::fail(ErrorCode::mismatch, path.string(),
                     "has shape " + shape_text(array->shape) + ", expected " + std::string(expected));
  }
  return array;
}

}  // namespace

Result<NpyArray> read_npy(const std::filesystem::path& path, int min_dims, int max_dims) {
  auto file = open_for_reading(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto opened = read_header(*file, path);
  if (!opened) return tl::unexpected(std::move(opened.error()));
  NpyHeader& header = opened->header;
  if (auto ok = check_dims(path, header, min_dims, max_dims); !ok) return tl::unexpected(std::move(ok.error()));
  const auto count = checked_count(path, header);
  if (!count) return tl::unexpected(count.error());
  if (const auto size = regular_size(*file)) {
    const std::uint64_t expected = *count * item_bytes(header.type),
                        actual = *size - std::min(*size, opened->data_offset);
    if (actual < expected) return truncated(path, "data", expected, actual);
  }
  auto values = read_values(*file, path, header, *count);
  if (!values) return tl::unexpected(std::move(values.error()));
  return NpyArray{std::move(header.shape), std::move(*values)};
}

Result<NpyArray> read_matrix(const std::filesystem::path& path) {
  return read_with_int_lengths(path, 2, 2, "a matrix of shape (rows, columns)");
}

Result<SampleArray> read_samples(const std::filesystem::path& path) {
  auto array = read_with_int_lengths(path, 1, 2, "samples of shape (M,) or (frames, M)");
  if (!array) return tl::unexpected(std::move(array.error()));
  const bool framed = array->shape.size() == 2;
  return SampleArray{framed ? array->shape[0] : 1, array->shape.back(), framed, std::move(array->values)};
}

Result<PictureArray> read_pictures(const std::filesystem::path& path) {
  auto array = read_with_int_lengths(path, 2, 3, "pictures of shape (H, W) or (frames, H, W)");
  if (!array) return tl::unexpected(std::move(array.error()));
  const bool framed = array->shape.size() == 3;
  const auto& shape = array->shape;
  const std::size_t first = framed ? 1 : 0;
  return PictureArray{framed ? shape[0] : 1, shape[first], shape[first + 1], framed, std::move(array->values)};
}

Result<hal::Image> read_picture(const std::filesystem::path& path) {
  auto pictures = read_pictures(path);
  if (!pictures) return tl::unexpected(std::move(pictures.error()));
  if (pictures->frames != 1) {
    return hal::fail(ErrorCode::mismatch, path.string(),
                     "holds " + std::to_string(pictures->frames) + " pictures, expected one of shape (H, W)");
  }
  hal::Image image;
  image.rows = static_cast<int>(pictures->rows);
  image.cols = static_cast<int>(pictures->cols);
  image.pixels.reserve(pictures->values.size());
  for (const double value : pictures->values) {
    if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) {
      const std::int64_t shape[] = {pictures->rows, pictures->cols};
      return hal::fail(ErrorCode::out_of_range, path.string(),
                       "has a value beyond float32 at " + index_text(shape, image.pixels.size()) +
                           ", expected intensities around 0 to 1");
    }
    image.pixels.push_back(static_cast<float>(value));
  }
  return image;
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

Result<void> write_npy(const std::filesystem::path& path, std::span<const std::int64_t> shape,
                       std::span<const float> values) {
  return write_array(path, NpyType::f4, shape, values);
}

Result<void> write_npy(const std::filesystem::path& path, std::span<const std::int64_t> shape,
                       std::span<const double> values) {
  return write_array(path, NpyType::f8, shape, values);
}

}  // namespace compueye::firmware
