#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "firmware/files/npy.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::bytes_of;
using compueye::test::Named;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

std::string npy(const std::string& dict, const std::string& data, int major = 1) {
  std::string text = dict;
  text += '\n';
  std::string out = "\x93NUMPY";
  out += static_cast<char>(major);
  out += '\0';
  for (unsigned shift = 0; shift < (major == 1 ? 16U : 32U); shift += 8) {
    out += static_cast<char>((text.size() >> shift) & 0xFFU);
  }
  return out + text + data;
}

std::string dict(const std::string& descr, const std::string& shape, bool fortran = false) {
  return "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
}

template <class T>
std::string raw(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

}  // namespace

TEST_CASE("arrays come back as they were written") {
  const TemporaryFolder folder;
  const auto path = folder / "a.npy";
  const std::int64_t shape[] = {2, 3};
  const std::vector<double> values{0.1, -1e-300, 1e300, std::nan(""), std::numeric_limits<double>::infinity(), -0.0};
  REQUIRE(write_npy(path, shape, std::span<const double>(values)).has_value());
  const auto back = read_npy(path, 1, 3).value();
  CHECK(back.shape == std::vector<std::int64_t>{2, 3});
  REQUIRE(back.values.size() == 6);
  CHECK(std::memcmp(back.values.data(), values.data(), 48) == 0);

  const std::vector<float> floats{0.1F, 0.2F, 0.3F, 1e-40F, 5.0F, 6.0F};
  REQUIRE(write_npy(path, shape, std::span<const float>(floats)).has_value());
  const auto matrix = read_matrix(path).value();
  for (std::size_t i = 0; i < 6; ++i) CHECK(matrix.values[i] == static_cast<double>(floats[i]));
  const std::string bytes = bytes_of(path);
  CHECK(bytes.size() % 64 == 24);
  CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  CHECK(bytes.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }") == 10);

  CHECK(write_npy(folder / "b.npy", shape, std::span<const double>(values).first(5)).error().code == ErrorCode::usage);
  const std::int64_t impossible[] = {-2, -3};
  CHECK_FALSE(write_npy(folder / "b.npy", impossible, std::span<const double>(values)).has_value());
  CHECK(folder.entries() == 1);
}

TEST_CASE("every lossless type, version and header spelling is read") {
  const TemporaryFolder folder;
  struct Case {
    std::string bytes;
    std::vector<double> values;
  };
  const std::vector<Case> cases{
      {npy(dict("<f2", "(4,)"), raw<std::uint16_t>({0x3C00, 0xC000, 0x0001, 0x7BFF})), {1, -2, 0x1p-24, 65504}},
      {npy(dict("|i1", "(2,)"), raw<std::int8_t>({-128, 127})), {-128, 127}},
      {npy(dict(">i1", "(1,)"), raw<std::int8_t>({-7})), {-7}},
      {npy(dict("<i2", "(1,)"), raw<std::int16_t>({-32768})), {-32768}},
      {npy(dict("<i4", "(1,)"), raw<std::int32_t>({-2147483647})), {-2147483647}},
      {npy(dict("<i8", "(2,)"), raw<std::int64_t>({-9007199254740992, 9007199254740992})), {-0x1p53, 0x1p53}},
      {npy(dict("|u1", "(1,)"), raw<std::uint8_t>({255})), {255}},
      {npy(dict("<u2", "(1,)"), raw<std::uint16_t>({65535})), {65535}},
      {npy(dict("<u4", "(1,)"), raw<std::uint32_t>({4294967295U})), {4294967295.0}},
      {npy(dict("<u8", "(1,)"), raw<std::uint64_t>({9007199254740992U})), {0x1p53}},
      {npy(dict("|b1", "(3,)"), raw<std::uint8_t>({0, 1, 1})), {0, 1, 1}},
      {npy(dict("<f4", "(1,)"), raw<float>({0.5F}), 2), {0.5}},
      {npy(dict("<f4", "(1,)"), raw<float>({0.5F}), 3), {0.5}},
      {npy(dict("<f4", "(1L,)"), raw<float>({0.5F})), {0.5}},
      {npy(dict("<f4", "(1,)", true), raw<float>({0.5F})), {0.5}},
      {npy(dict(">f2", "(2,)"), std::string("\x3C\x00\xC0\x00", 4)), {1, -2}},
      {npy(dict(">f4", "(2,)"), std::string("\x3F\x00\x00\x00\xBF\x80\x00\x00", 8)), {0.5, -1}},
      {npy(dict(">f8", "(1,)"), std::string("\x3F\xD5\x55\x55\x55\x55\x55\x55", 8)), {0x1.5555555555555p-2}},
      {npy(dict(">i2", "(2,)"), std::string("\xFF\xFE\x01\x00", 4)), {-2, 256}},
      {npy(dict(">u4", "(1,)"), std::string("\xFF\xFF\xFF\xFE", 4)), {4294967294.0}},
      {npy("{\"shape\":(1,),\"fortran_order\":False,\"descr\":\"<f8\"}", raw<double>({0.5})), {0.5}},
      {npy(dict("<f4", "(1,)") + std::string(500, ' '), raw<float>({0.5F})), {0.5}},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CAPTURE(i);
    const auto array = read_npy(folder.file("a.npy", cases[i].bytes), 1, 1);
    REQUIRE_MESSAGE(array.has_value(), (array ? "" : array.error().text()));
    CHECK(array->values == cases[i].values);
  }
  const auto halves =
      read_npy(folder.file("h.npy", npy(dict("<f2", "(3,)"), raw<std::uint16_t>({0x7C00, 0xFC00, 0x7E00}))), 1, 1);
  CHECK(halves->values[0] == HUGE_VAL);
  CHECK(halves->values[1] == -HUGE_VAL);
  CHECK(std::isnan(halves->values[2]));
}

TEST_CASE("Fortran order is read into C order, and means nothing in one row") {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& shape, const std::vector<float>& values) {
    return read_npy(folder.file("a.npy", npy(dict("<f4", shape, true), raw<float>(values))), 1, 3).value().values;
  };
  CHECK(read("(2, 3)", {1, 4, 2, 5, 3, 6}) == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(read("(2, 3, 2)", {0, 6, 2, 8, 4, 10, 1, 7, 3, 9, 5, 11}) ==
        std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  CHECK(read("(1, 4)", {1, 2, 3, 4}) == std::vector<double>{1, 2, 3, 4});
  CHECK(read("(4, 1)", {1, 2, 3, 4}) == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("a hostile .npy is refused with a sentence that helps") {
  const TemporaryFolder folder;
  struct Case {
    const char* what;
    std::string bytes;
    ErrorCode code;
    Named named;
  };
  const std::string four = raw<float>({1, 2, 3, 4});
  const std::string good = dict("<f4", "(2, 2)");
  const std::vector<Case> cases{
      {"empty file", "", ErrorCode::bad_format, {"NumPy", ".npy"}},
      {"text", "1 2 3 4 5 6 7 8", ErrorCode::bad_format, {"NumPy", ".npy"}},
      {"npz", "PK\x03\x04 and so on", ErrorCode::bad_format, {"NumPy", ".npy"}},
      {"magic only", "\x93NUMPY", ErrorCode::bad_format, {"10", "6"}},
      {"version 4", npy(good, four, 4), ErrorCode::unsupported, {"4.0", "1.0", "2.0", "3.0"}},
      {"header cut", npy(good, four).substr(0, 40), ErrorCode::bad_format, {"60", "30"}},
      {"huge header",
       std::string("\x93NUMPY\x02\x00\xff\xff\xff\xff", 12),
       ErrorCode::bad_format,
       {"4294967295", "65535"}},
      {"no byte order", npy(dict("=f4", "(2, 2)"), four), ErrorCode::unsupported, {"=f4", "<f4", ">f4"}},
      {"complex", npy(dict("<c8", "(2,)"), four), ErrorCode::unsupported, {"<c8"}},
      {"string", npy(dict("<U4", "(1,)"), four), ErrorCode::unsupported, {"<U4"}},
      {"bytes", npy(dict("|S16", "(1,)"), four), ErrorCode::unsupported, {"|S16"}},
      {"object", npy(dict("|O", "(2,)"), four), ErrorCode::unsupported, {"|O"}},
      {"long double", npy(dict("<f16", "(1,)"), four), ErrorCode::unsupported, {"<f16", "64"}},
      {"dates", npy(dict("<M8[ns]", "(2,)"), four), ErrorCode::unsupported, {"<M8[ns]"}},
      {"void", npy(dict("|V4", "(4,)"), four), ErrorCode::unsupported, {"|V4"}},
      {"structured",
       npy("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (4,), }", four),
       ErrorCode::unsupported,
       {"arr['name']"}},
      {"no descr",
       npy("{'fortran_order': False, 'shape': (4,), }", four),
       ErrorCode::bad_format,
       {"descr", "fortran_order", "shape"}},
      {"twice",
       npy("{'shape': (4,), 'shape': (4,), 'descr': '<f4', 'fortran_order': False}", four),
       ErrorCode::bad_format,
       {"'shape'"}},
      {"extra key",
       npy("{'shape': (4,), 'x': 1, 'descr': '<f4', 'fortran_order': False}", four),
       ErrorCode::bad_format,
       {"'x'"}},
      {"order 0",
       npy("{'shape': (4,), 'descr': '<f4', 'fortran_order': 0}", four),
       ErrorCode::bad_format,
       {"fortran_order", "True", "False"}},
      {"tail", npy(good + "()", four), ErrorCode::bad_format, {"'}'"}},
      {"shape list", npy(dict("<f4", "[4]"), four), ErrorCode::bad_format, {"shape"}},
      {"negative", npy(dict("<f4", "(-2, -2)"), four), ErrorCode::bad_format, {"-2"}},
      {"float shape", npy(dict("<f4", "(2.0, 2)"), four), ErrorCode::bad_format, {"shape"}},
      {"overflowing length", npy(dict("<f4", "(99999999999999999999,)"), four), ErrorCode::bad_format, {"shape"}},
      {"overflowing product",
       npy(dict("<f4", "(4294967296, 4294967296)"), four),
       ErrorCode::bad_format,
       {"(4294967296, 4294967296)"}},
      {"overflowing bytes",
       npy(dict("<f8", "(4611686018427387904,)"), four),
       ErrorCode::bad_format,
       {"(4611686018427387904,)"}},
      {"large claim", npy(dict("<f4", "(100000, 100000)"), four), ErrorCode::bad_format, {"40000000000", "16"}},
      {"truncated", npy(good, four.substr(0, 15)), ErrorCode::bad_format, {"16", "15"}},
      {"no data", npy(good, ""), ErrorCode::bad_format, {"16", "0"}},
      {"trailing", npy(good, four + "x"), ErrorCode::bad_format, {"16", "(2, 2)"}},
      {"zero size", npy(dict("<f4", "(0, 64)"), ""), ErrorCode::out_of_range, {"(0, 64)"}},
      {"0-d", npy(dict("<f4", "()"), four.substr(0, 4)), ErrorCode::mismatch, {"()", "0", "1", "2"}},
      {"3-d", npy(dict("<f4", "(1, 2, 2)"), four), ErrorCode::mismatch, {"3", "(1, 2, 2)", "1", "2"}},
      {"33-d", npy(dict("<f4", "(1," + std::string(64, '1') + ")"), four), ErrorCode::bad_format, {"shape"}},
      {"2^53 + 1",
       npy(dict("<i8", "(1, 2)"), raw<std::int64_t>({5, 9007199254740993})),
       ErrorCode::out_of_range,
       {"9007199254740993", "(0, 1)"}},
      {"-2^53 - 1",
       npy(dict("<i8", "(1,)"), raw<std::int64_t>({-9007199254740993})),
       ErrorCode::out_of_range,
       {"-9007199254740993", "(0)"}},
      {"u8 max",
       npy(dict("<u8", "(1,)"), raw<std::uint64_t>({~0ULL})),
       ErrorCode::out_of_range,
       {"18446744073709551615", "(0)"}},
      {"big-endian 2^53 + 1",
       npy(dict(">i8", "(1,)"), std::string("\x00\x20\x00\x00\x00\x00\x00\x01", 8)),
       ErrorCode::out_of_range,
       {"9007199254740993", "(0)"}},
      {"Fortran 2^53 + 1",
       npy(dict("<i8", "(2, 3)", true), raw<std::int64_t>({0, 9007199254740993, 0, 0, 0, 0})),
       ErrorCode::out_of_range,
       {"9007199254740993", "(1, 0)"}},
      {"bool 2", npy(dict("|b1", "(2,)"), std::string("\x01\x02")), ErrorCode::out_of_range, {"2", "(1)", "0", "1"}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const auto path = folder.file("hostile.npy", c.bytes);
    test::check_error(read_npy(path, 1, 2), c.code, path.string(), c.named);
  }
  test::check_error(read_npy(folder / "missing.npy", 1, 2), ErrorCode::not_found, (folder / "missing.npy").string(),
                    {});
  test::check_error(read_npy(folder.path(), 1, 2), ErrorCode::io, folder.path().string(), {});
}

TEST_CASE("typed readers accept their shapes and no other") {
  const TemporaryFolder folder;
  const auto with = [&](const std::string& shape) {
    return folder.file("a.npy", npy(dict("<f4", shape), raw<float>(std::vector<float>(12, 0.5F))));
  };
  const auto one = read_samples(with("(12,)"), 12).value();
  CHECK(one.frames == 1);
  CHECK(one.channels == 12);
  CHECK_FALSE(one.has_frame_axis);
  const auto many = read_samples(with("(3, 4)"), 4).value();
  CHECK(many.frames == 3);
  CHECK(many.channels == 4);
  CHECK(many.has_frame_axis);
  CHECK(many.frame(2).size() == 4);
  const auto column = read_samples(with("(12, 1)"), 12).value();
  CHECK(column.frames == 1);
  CHECK(column.channels == 12);
  CHECK_FALSE(column.has_frame_axis);
  const auto single = read_samples(with("(12, 1)"), 1).value();
  CHECK(single.frames == 12);
  CHECK(single.channels == 1);
  CHECK(read_samples(with("(3, 2, 2)"), 12).error().code == ErrorCode::mismatch);

  const auto picture = read_pictures(with("(3, 4)")).value();
  CHECK(picture.frames == 1);
  CHECK(picture.rows == 3);
  CHECK(picture.cols == 4);
  const auto pictures = read_pictures(with("(3, 2, 2)")).value();
  CHECK(pictures.frames == 3);
  CHECK(pictures.rows == 2);
  CHECK(pictures.has_frame_axis);
  CHECK(read_pictures(with("(12,)")).error().code == ErrorCode::mismatch);
  test::check_error(read_pictures(with("(1, 3, 2, 2)")), ErrorCode::mismatch, (folder / "a.npy").string(),
                    {"(1, 3, 2, 2)"});

  CHECK(read_matrix(with("(3, 4)")).has_value());
  test::check_error(read_matrix(with("(12,)")), ErrorCode::mismatch, (folder / "a.npy").string(), {"(12,)"});
  CHECK(read_matrix(folder.file("l.npy", npy(dict("|u1", "(3000000000, 1)"), "x"))).error().code ==
        ErrorCode::bad_format);
}

TEST_CASE("the first NaN or infinity is found and placed") {
  std::vector<double> values(12, 0.5);
  CHECK_FALSE(first_non_finite(values).has_value());
  CHECK_FALSE(first_non_finite({}).has_value());
  values[11] = std::nan("");
  values[7] = -HUGE_VAL;
  CHECK(first_non_finite(values).value() == 7);
  const std::int64_t two[] = {3, 4}, three[] = {3, 2, 2}, one[] = {12};
  CHECK(index_text(two, 7) == "(1, 3)");
  CHECK(index_text(three, 7) == "(1, 1, 1)");
  CHECK(index_text(one, 7) == "(7)");
}

TEST_CASE("a damaged .npy is an error or an array, never a crash") {
  const TemporaryFolder folder;
  const std::string good = npy(dict("<i8", "(4, 5)") + "    ", raw<std::int64_t>(std::vector<std::int64_t>(20, 77)), 2);
  int refused = 0, read = 0;
  for (std::size_t n = 0; n < 3000; ++n) {
    const auto array = read_npy(folder.file("fuzz.npy", test::damaged(good, n)), 1, 3);
    if (array) {
      ++read;
      std::size_t count = 1;
      for (const auto length : array->shape) count *= static_cast<std::size_t>(length);
      REQUIRE(array->values.size() == count);
    } else {
      ++refused;
      REQUIRE_FALSE(array.error().sentence.empty());
    }
  }
  CHECK(refused > 500);
  CHECK(read > 100);
}
