#include <doctest/doctest.h>

#include <vector>

#include "tests/calib/eye_file/small_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::calib;
using namespace compueye::calib::tests;
using compueye::test::check_error;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

EyeFile opened(const std::string& path, EyeFileMode mode) {
  auto file = EyeFile::open(path, mode);
  REQUIRE_MESSAGE(file.has_value(), file.error().text());
  return std::move(*file);
}

EyeFile created(const std::string& path) {
  auto file = EyeFile::create(path, small_eye());
  REQUIRE_MESSAGE(file.has_value(), file.error().text());
  return std::move(*file);
}

}  // namespace

TEST_CASE("eye file: all that was stored comes back bit for bit, from one file") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  CHECK(folder.entries() == 1);
  REQUIRE(read_small_file(path).has_value());

  const EyeFile file = opened(path, EyeFileMode::read);
  const EyeIdentity eye = small_eye();
  CHECK(file.eye().geometry.lattice == eye.geometry.lattice);
  CHECK(file.eye().geometry.columns == 2);
  CHECK(same_bits(file.eye().geometry.acceptance_rad, eye.geometry.acceptance_rad));
  CHECK(file.eye().plane.cols == 5);

  const auto sessions = *file.sessions();
  REQUIRE(sessions.size() == 2);
  REQUIRE(sessions[0].end.has_value());
  CHECK(sessions[0].end->captures == 5);
  CHECK(sessions[0].end->raw_hash == *file.raw_hash(std::vector<std::int64_t>{1}));
  CHECK_FALSE(sessions[1].end.has_value());
  CHECK(*file.capture_count(2) == 3);
  const auto estimates = *file.estimates();
  REQUIRE(estimates.size() == 1);
  CHECK(estimates[0].raw_hash == *file.raw_hash(std::vector<std::int64_t>{1, 2}));
  CHECK(estimates[0].raw_hash != *file.raw_hash(std::vector<std::int64_t>{1}));
  CHECK(estimates[0].method == "hybrid");
  CHECK(folder.entries() == 1);
}

TEST_CASE("eye file: goes on where it was left, and numbers captures, sessions and estimates") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  EyeFile file = opened(path, EyeFileMode::write);
  CHECK(*file.append_capture(2, small_capture(13)) == 3);
  CHECK(*file.append_capture(2, small_capture(14)) == 4);
  CHECK(*file.begin_session(small_session(2)) == 3);
  CHECK(*file.append_capture(3, small_capture(20)) == 0);
  Estimate second = small_estimate({3}, 1);
  second.parent = 1;
  CHECK(*file.store_estimate(second, small_response(1), {}) == 2);
  CHECK(same(*file.load_estimate(2), second));
  const auto response = file.load_response(2);
  CHECK(same(response->response, small_response(1)));
  CHECK(response->sigma.empty());
  CHECK(same(*file.load_estimate(1), small_estimate({1, 2})));

  // What an estimate was made from has changed since.
  CHECK(file.estimates()->front().raw_hash != *file.raw_hash(std::vector<std::int64_t>{1, 2}));
  REQUIRE(file.end_session(2).has_value());
  CHECK(file.sessions()->at(1).end->captures == 5);
  check_error(file.append_capture(2, small_capture(15)), ErrorCode::usage, path, {"2", "5"});
  check_error(file.end_session(2), ErrorCode::usage, path, {"2", "5"});
}

TEST_CASE("eye file: a reader sees captures while they are added") {
  const TemporaryFolder folder;
  EyeFile file = created(folder / "F.eye");
  const std::int64_t session = *file.begin_session(small_session());
  auto reader = *file.captures(session);
  CHECK_FALSE(reader.next()->has_value());
  for (int k = 0; k < 3; ++k) {
    CHECK(*file.append_capture(session, small_capture(k)) == k);
    CHECK(same(**reader.next(), small_capture(k)));
  }
  CHECK_FALSE(reader.next()->has_value());
}

TEST_CASE("eye file: a dense response, an empty one and one of several blocks") {
  const TemporaryFolder folder;
  EyeFile file = created(folder / "F.eye");
  std::vector<double> values;
  for (int n = 0; n < 6 * 7; ++n) values.push_back(n * 0.25 - 3.0);
  const auto dense = *recon::Response::from_dense(6, 7, values);
  const auto nothing = *recon::Response::from_csr(6, 9, std::vector<std::int64_t>(7, 0), {}, {});
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  values.clear();
  for (int m = 0; m < 6; ++m) {
    for (int c = 0; c < 100'000; ++c) {
      columns.push_back(c);
      values.push_back((c % 1000 + 1) * 0x1p-10 * (m + 1));
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  const auto wide = *recon::Response::from_csr(6, 100'000, start, columns, values);
  for (const recon::Response* each : {&dense, &nothing, &wide}) {
    const std::vector<float> sigma = small_sigma(*each);
    const auto id = file.store_estimate(small_estimate({}), *each, sigma);
    REQUIRE(id.has_value());
    const auto loaded = file.load_response(*id);
    REQUIRE(loaded.has_value());
    CHECK(same(loaded->response, *each));
    CHECK(loaded->sigma == sigma);
  }
}

TEST_CASE("eye file: entries are rounded to float32, and what it cannot hold is refused whole") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  EyeFile file = created(path);
  std::vector<double> values(12, 0.1);
  REQUIRE(file.store_estimate(small_estimate({}), *recon::Response::from_dense(6, 2, values), {}).has_value());
  CHECK(file.load_response(1)->response.values()[3] == static_cast<double>(0.1F));
  values[5] = 1e39;
  check_error(file.store_estimate(small_estimate({}), *recon::Response::from_dense(6, 2, values), {}),
              ErrorCode::out_of_range, path, {"float32"});
  check_error(
      file.store_estimate(small_estimate({}), small_response(),
                          std::vector<float>(static_cast<std::size_t>(small_response().stored_entries()), -1.0F)),
      ErrorCode::out_of_range, path, {});
  CHECK(file.estimates()->size() == 1);
}

TEST_CASE("eye file: what makes no sense is refused before it is stored") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  EyeFile file = created(path);
  const std::int64_t session = *file.begin_session(small_session());

  Capture capture = small_capture(0);
  capture.codes.pop_back();
  check_error(file.append_capture(session, capture), ErrorCode::mismatch, path, {"5", "6"});
  capture = small_capture(0);
  capture.valid = {1};
  check_error(file.append_capture(session, capture), ErrorCode::mismatch, path, {"1", "6"});
  capture = small_capture(0);
  capture.frames = 0;
  check_error(file.append_capture(session, capture), ErrorCode::out_of_range, path, {"0"});
  capture = small_capture(0);
  capture.temperature_c = unknown;
  check_error(file.append_capture(session, capture), ErrorCode::out_of_range, path, {});
  check_error(file.append_capture(7, small_capture(0)), ErrorCode::not_found, path, {"7"});
  check_error(file.captures(7), ErrorCode::not_found, path, {"7"});
  CHECK(*file.capture_count(session) == 0);

  Session bad = small_session();
  bad.bits = 25;
  check_error(file.begin_session(bad), ErrorCode::out_of_range, path, {"25", "24"});
  bad = small_session();
  bad.distance_mm = unknown;
  check_error(file.begin_session(bad), ErrorCode::out_of_range, path, {"0"});
  CHECK(file.sessions()->size() == 1);
}

TEST_CASE("eye file: an estimate whose parts do not fit is refused whole") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  EyeFile file = created(path);
  REQUIRE(file.begin_session(small_session()).has_value());
  const auto refused = [&](ErrorCode code, auto change) {
    Estimate estimate = small_estimate({1});
    change(estimate);
    check_error(file.store_estimate(estimate, small_response(), {}), code, path, {});
  };
  refused(ErrorCode::mismatch, [](Estimate& e) { e.status.pop_back(); });
  refused(ErrorCode::mismatch, [](Estimate& e) { e.dark_level_lsb.pop_back(); });
  refused(ErrorCode::mismatch, [](Estimate& e) { e.chi2.push_back(1.0); });
  refused(ErrorCode::mismatch, [](Estimate& e) { e.parameters[1].values.pop_back(); });
  refused(ErrorCode::mismatch, [](Estimate& e) { e.linearity_values.pop_back(); });
  refused(ErrorCode::mismatch, [](Estimate& e) { e.residual.pop_back(); });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.residual_counts[1] = -1; });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.distance_mm = unknown; });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.residual[0] = std::numeric_limits<float>::infinity(); });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.linearity_codes = {0, 4095, 4095}; });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.kappas[0].value = std::numeric_limits<double>::infinity(); });
  refused(ErrorCode::out_of_range, [](Estimate& e) { e.sessions = {1, 1}; });
  refused(ErrorCode::not_found, [](Estimate& e) { e.sessions = {1, 2}; });
  refused(ErrorCode::not_found, [](Estimate& e) { e.parent = 1; });
  check_error(file.store_estimate(small_estimate({1}), *recon::Response::from_dense(5, 1, {1, 2, 3, 4, 5}), {}),
              ErrorCode::mismatch, path, {"5", "6"});
  check_error(file.store_estimate(small_estimate({1}), small_response(), std::vector<float>{1.0F}), ErrorCode::mismatch,
              path, {"1"});
  CHECK(file.estimates()->empty());
  check_error(file.load_estimate(1), ErrorCode::not_found, path, {"1"});
  check_error(file.load_response(1), ErrorCode::not_found, path, {"1"});
  REQUIRE(file.store_estimate(small_estimate({1}), small_response(), {}).has_value());
}

TEST_CASE("eye file: a file for reading is not written, a closed one not used") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  const std::string before = test::bytes_of(path);
  EyeFile file = opened(path, EyeFileMode::read);
  check_error(file.begin_session(small_session()), ErrorCode::usage, path, {});
  check_error(file.append_capture(2, small_capture(0)), ErrorCode::usage, path, {});
  check_error(file.end_session(2), ErrorCode::usage, path, {});
  check_error(file.store_estimate(small_estimate({1}), small_response(), {}), ErrorCode::usage, path, {});
  auto reader = *file.captures(1);
  CHECK(reader.next()->has_value());
  REQUIRE(file.close().has_value());
  REQUIRE(file.close().has_value());
  check_error(file.sessions(), ErrorCode::usage, path, {});
  check_error(file.load_response(1), ErrorCode::usage, path, {});
  check_error(reader.next(), ErrorCode::usage, path, {});
  CHECK(test::bytes_of(path) == before);
}
