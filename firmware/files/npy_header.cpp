#include "firmware/files/npy_header.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied from and to little-endian files");

using hal::ErrorCode;
using hal::Result;

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

std::optional<std::string> append_halves(const char* from, std::size_t count, std::vector<double>& out) {
  for (std::size_t i = 0; i < count; ++i) out.push_back(half_to_double(load<std::uint16_t>(from + 2 * i)));
  return std::nullopt;
}

std::optional<std::string> append_booleans(const char* from, std::size_t count, std::vector<double>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<unsigned char>(from[i]);
    if (value > 1) return std::to_string(value);
    out.push_back(value);
  }
  return std::nullopt;
}

constexpr std::array<NpyType, 12> types{{{"f2", 2, append_halves},
                                         {"f4", 4, append<float>},
                                         {"f8", 8, append<double>},
                                         {"i1", 1, append<std::int8_t>},
                                         {"i2", 2, append<std::int16_t>},
                                         {"i4", 4, append<std::int32_t>},
                                         {"i8", 8, append<std::int64_t>},
                                         {"u1", 1, append<std::uint8_t>},
                                         {"u2", 2, append<std::uint16_t>},
                                         {"u4", 4, append<std::uint32_t>},
                                         {"u8", 8, append<std::uint64_t>},
                                         {"b1", 1, append_booleans}}};

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// Just enough of Python's literal syntax for the one dictionary NumPy writes.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool take(char c) {
    skip_space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] bool next_is(char c) {
    skip_space();
    return at_ < text_.size() && text_[at_] == c;
  }
  std::optional<std::string_view> quoted() {
    skip_space();
    if (at_ >= text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) return std::nullopt;
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) return std::nullopt;
    const auto inside = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return inside;
  }
  std::optional<std::string_view> word() {
    skip_space();
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] >= 'A' && text_[at_] <= 'z') ++at_;
    return at_ > begin ? std::optional(text_.substr(begin, at_ - begin)) : std::nullopt;
  }
  std::optional<std::int64_t> integer() {
    skip_space();
    std::int64_t value = 0;
    const char* begin = text_.data() + at_;
    const auto [end, ec] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (ec != std::errc()) return std::nullopt;
    at_ += static_cast<std::size_t>(end - begin);
    // Python 2 wrote long integers with an L.
    if (at_ < text_.size() && text_[at_] == 'L') ++at_;
    return value;
  }
  bool at_end() {
    skip_space();
    return at_ == text_.size();
  }

 private:
  void skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

std::string printable(std::string_view text) {
  std::string out(text.substr(0, 40));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

tl::unexpected<hal::Error> not_a_header(const std::string& path, const std::string& what) {
  return hal::fail(
      ErrorCode::bad_format, path,
      "has a damaged .npy header (" + what + "), expected a dictionary with the keys descr, fortran_order and shape");
}

std::string_view refused_kind(char kind) {
  switch (kind) {
    case 'c':
      return "complex numbers";
    case 'S':
    case 'a':
    case 'U':
      return "strings";
    case 'O':
      return "Python objects";
    case 'V':
      return "raw or structured records";
    case 'M':
    case 'm':
      return "dates or times";
    default:
      return "elements of a kind unknown here";
  }
}

Result<void> parse_descr(const std::string& path, std::string_view descr, NpyHeader& header) {
  const bool has_order = !descr.empty() && std::string_view("<>|=").find(descr[0]) != std::string_view::npos;
  const char order = has_order ? descr[0] : '|';
  const std::string_view code = has_order ? descr.substr(1) : descr;
  const std::string quoted = "'" + printable(descr) + "'";
  const auto* known = std::find_if(types.begin(), types.end(), [&](const NpyType& t) { return t.code == code; });
  if (known == types.end()) {
    const char kind = code.empty() ? '?' : code[0];
    const std::string what = kind == 'f' ? "floats wider than 64 bits" : std::string(refused_kind(kind));
    return hal::fail(ErrorCode::unsupported, path,
                     "holds " + what + " (dtype " + quoted +
                         "), expected real numbers: f4 or f8, or integers, e.g. numpy.save(name, arr.astype('<f4'))");
  }
  if (known->bytes > 1 && order != '<' && order != '>') {
    return hal::fail(ErrorCode::unsupported, path,
                     "does not say its byte order (dtype " + quoted + "), expected '<" + std::string(code) + "' or '>" +
                         std::string(code) + "'");
  }
  header.type = known;
  header.big_endian = known->bytes > 1 && order == '>';
  return {};
}

Result<std::vector<std::int64_t>> parse_shape(const std::string& path, Scanner& scan) {
  if (!scan.take('(')) return not_a_header(path, "shape is not a tuple");
  std::vector<std::int64_t> shape;
  while (!scan.take(')')) {
    const auto length = scan.integer();
    if (!length) return not_a_header(path, "shape is not a tuple of whole numbers");
    if (*length < 0) return not_a_header(path, "shape has the negative length " + std::to_string(*length));
    shape.push_back(*length);
    if (shape.size() > 32) return not_a_header(path, "shape has more than 32 dimensions");
    if (!scan.take(',') && !scan.next_is(')')) return not_a_header(path, "shape is not closed");
  }
  return shape;
}

struct Fields {
  std::optional<std::string_view> descr;
  std::optional<bool> fortran;
  std::optional<std::vector<std::int64_t>> shape;
};

Result<void> parse_field(const std::string& path, Scanner& scan, Fields& fields) {
  const auto key = scan.quoted();
  if (!key || !scan.take(':')) return not_a_header(path, "a key is missing");
  if (*key == "descr" && !fields.descr) {
    if (scan.next_is('[')) {
      return hal::fail(ErrorCode::unsupported, path,
                       "holds structured records, expected plain real numbers: save one field, e.g. arr['name']");
    }
    fields.descr = scan.quoted();
    if (!fields.descr) return not_a_header(path, "descr is not a string");
  } else if (*key == "fortran_order" && !fields.fortran) {
    const auto value = scan.word();
    if (!value || (*value != "True" && *value != "False")) {
      return not_a_header(path, "fortran_order is neither True nor False");
    }
    fields.fortran = *value == "True";
  } else if (*key == "shape" && !fields.shape) {
    fields.shape = TRY(parse_shape(path, scan));
  } else {
    return not_a_header(path, "key '" + printable(*key) + "' is unknown or repeated");
  }
  return {};
}

}  // namespace

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string text = "(";
  for (std::size_t d = 0; d < shape.size(); ++d) {
    if (d > 0) text += ", ";
    text += std::to_string(shape[d]);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

Result<NpyHeader> parse_npy_header(const std::string& path, std::string_view text) {
  Scanner scan(text);
  Fields fields;
  if (!scan.take('{')) return not_a_header(path, "it does not begin with '{'");
  while (!scan.take('}')) {
    TRY(parse_field(path, scan, fields));
    if (!scan.take(',') && !scan.next_is('}')) return not_a_header(path, "it is not closed");
  }
  if (!scan.at_end()) return not_a_header(path, "something follows its '}'");
  if (!fields.descr || !fields.fortran || !fields.shape) return not_a_header(path, "a key is missing");
  NpyHeader header{.shape = std::move(*fields.shape)};
  TRY(parse_descr(path, *fields.descr, header));
  // The order is a matter of two axes at least that have more than one index.
  header.fortran = *fields.fortran && std::count_if(header.shape.begin(), header.shape.end(),
                                                    [](std::int64_t length) { return length > 1; }) > 1;
  return header;
}

std::string format_npy_header(std::string_view descr, std::span<const std::int64_t> shape, std::size_t min_bytes) {
  const std::string dict =
      "{'descr': '" + std::string(descr) + "', 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
  const std::size_t least = std::max(npy_preamble_v1_bytes + dict.size() + 1, min_bytes);
  const std::size_t total = (least + 63) / 64 * 64;
  const std::size_t length = total - npy_preamble_v1_bytes;
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(length & 0xFFU);
  header += static_cast<char>(length >> 8U);
  header += dict;
  header.resize(total - 1, ' ');
  return header + '\n';
}

}  // namespace compueye::firmware
