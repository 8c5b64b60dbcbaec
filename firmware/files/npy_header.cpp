#include "firmware/files/npy_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

struct TypeName {
  NpyType type;
  std::string_view code;
  std::size_t bytes;
};
constexpr std::array<TypeName, 12> type_names{{{NpyType::f2, "f2", 2},
                                               {NpyType::f4, "f4", 4},
                                               {NpyType::f8, "f8", 8},
                                               {NpyType::i1, "i1", 1},
                                               {NpyType::i2, "i2", 2},
                                               {NpyType::i4, "i4", 4},
                                               {NpyType::i8, "i8", 8},
                                               {NpyType::u1, "u1", 1},
                                               {NpyType::u2, "u2", 2},
                                               {NpyType::u4, "u4", 4},
                                               {NpyType::u8, "u8", 8},
                                               {NpyType::b1, "b1", 1}}};

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

tl::unexpected<hal::Error> not_a_header(const std::filesystem::path& path, const std::string& what) {
  return hal::fail(
      ErrorCode::bad_format, path.string(),
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

Result<NpyType> parse_descr(const std::filesystem::path& path, std::string_view descr) {
  const bool has_order = !descr.empty() && std::string_view("<>|=").find(descr[0]) != std::string_view::npos;
  const char order = has_order ? descr[0] : '|';
  const std::string_view code = has_order ? descr.substr(1) : descr;
  const std::string quoted = "'" + printable(descr) + "'";
  const auto known =
      std::find_if(type_names.begin(), type_names.end(), [&](const TypeName& t) { return t.code == code; });
  if (known == type_names.end()) {
    const char kind = code.empty() ? '?' : code[0];
    const std::string what = kind == 'f' ? "floats wider than 64 bits" : std::string(refused_kind(kind));
    return hal::fail(ErrorCode::unsupported, path.string(),
                     "holds " + what + " (dtype " + quoted +
                         "), expected real numbers: f4 or f8, or integers, e.g. numpy.save(name, arr.astype('<f4'))");
  }
  if (known->bytes > 1 && order != '<') {
    const std::string how = order == '>' ? "is big-endian" : "does not say its byte order";
    return hal::fail(ErrorCode::unsupported, path.string(),
                     how + " (dtype " + quoted + "), expected little-endian: save arr.astype('<" + std::string(code) +
                         "'), or arr.astype('<f4')");
  }
  return known->type;
}

Result<std::vector<std::int64_t>> parse_shape(const std::filesystem::path& path, Scanner& scan) {
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

Result<void> parse_field(const std::filesystem::path& path, Scanner& scan, Fields& fields) {
  const auto key = scan.quoted();
  if (!key || !scan.take(':')) return not_a_header(path, "a key is missing");
  if (*key == "descr" && !fields.descr) {
    if (scan.next_is('[')) {
      return hal::fail(ErrorCode::unsupported, path.string(),
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
    auto shape = parse_shape(path, scan);
    if (!shape) return tl::unexpected(std::move(shape.error()));
    fields.shape = std::move(*shape);
  } else {
    return not_a_header(path, "key '" + printable(*key) + "' is unknown or repeated");
  }
  return {};
}

}  // namespace

std::size_t item_bytes(NpyType type) noexcept {
  return type_names[static_cast<std::size_t>(type)].bytes;
}

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string text = "(";
  for (std::size_t d = 0; d < shape.size(); ++d) {
    if (d > 0) text += ", ";
    text += std::to_string(shape[d]);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

Result<NpyHeader> parse_npy_header(const std::filesystem::path& path, std::string_view text) {
  Scanner scan(text);
  Fields fields;
  if (!scan.take('{')) return not_a_header(path, "it does not begin with '{'");
  while (!scan.take('}')) {
    if (auto ok = parse_field(path, scan, fields); !ok) return tl::unexpected(std::move(ok.error()));
    if (!scan.take(',') && !scan.next_is('}')) return not_a_header(path, "it is not closed");
  }
  if (!scan.at_end()) return not_a_header(path, "something follows its '}'");
  if (!fields.descr || !fields.fortran || !fields.shape) return not_a_header(path, "a key is missing");
  auto type = parse_descr(path, *fields.descr);
  if (!type) return tl::unexpected(std::move(type.error()));
  if (*fields.fortran && fields.shape->size() > 1) {
    return hal::fail(ErrorCode::unsupported, path.string(),
                     "is in Fortran order, expected C order (rows first): save numpy.ascontiguousarray(arr)");
  }
  return NpyHeader{*type, std::move(*fields.shape)};
}

std::string format_npy_header(NpyType type, std::span<const std::int64_t> shape, std::size_t min_bytes) {
  const TypeName& t = type_names[static_cast<std::size_t>(type)];
  const std::string dict = std::string("{'descr': '") + (t.bytes > 1 ? '<' : '|') + std::string(t.code) +
                           "', 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
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
