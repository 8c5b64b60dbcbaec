#include <doctest/doctest.h>

#include <cmath>
#include <regex>
#include <string>

#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/solver_row.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

constexpr std::string_view small_eye = "reconstruct --response A.mtx --samples y.npy --size 16x16 ";

/// `frames` scaled copies of the Fig. 2 pattern seen by the small eye, as y.npy and truth.npy.
void put_frames(const TemporaryFolder& folder, int frames) {
  const recon::Response a = make_small_eye(folder);
  const auto scene = sim::render_built_in("fig2", 16, 16, 0);
  REQUIRE(scene.has_value());
  std::vector<double> samples, truths;
  for (int f = 0; f < frames; ++f) {
    std::vector<double> x(scene->pixels.begin(), scene->pixels.end()), y(static_cast<std::size_t>(a.rows()));
    for (double& each : x) each *= 1.0 - 0.2 * f;
    a.forward(x, y);
    samples.insert(samples.end(), y.begin(), y.end());
    truths.insert(truths.end(), x.begin(), x.end());
  }
  put_npy(folder, "y.npy", {frames, a.rows()}, samples);
  put_npy(folder, "truth.npy", {frames, 16, 16}, truths);
}

std::vector<double> pictures_in(const std::filesystem::path& path) {
  auto pictures = firmware::read_pictures(path);
  REQUIRE(pictures.has_value());
  return pictures->values;
}

double relative_distance(std::span<const double> a, std::span<const double> b) {
  REQUIRE(a.size() == b.size());
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  REQUIRE(size > 0.0);
  return std::sqrt(difference / size);
}

}  // namespace

TEST_CASE("pictures on standard output are all there is on it, and --json does not go with them") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const auto piped = run_compueye(std::string(small_eye) + "--sigma 0.01 --iterations 20 --out -", folder.path());
  CHECK(piped.exit_code == 0);
  CHECK(piped.out.starts_with("\x93NUMPY"));
  CHECK(piped.err.find("objective") != std::string::npos);
  const auto filed = run_compueye(std::string(small_eye) + "--sigma 0.01 --iterations 20 --out x.npy", folder.path());
  CHECK(filed.exit_code == 0);
  CHECK(piped.out == bytes_of(folder.path() / "x.npy"));
  for (const char* both : {"--out - --json", "--out /dev/stdout --json", "--png - --json"}) {
    CAPTURE(both);
    const auto refused = run_compueye(std::string(small_eye) + "--sigma 0.01 " + both, folder.path());
    CHECK(refused.exit_code == 2);
    const auto json = nlohmann::json::parse(refused.out, nullptr, false);
    REQUIRE_FALSE(json.is_discarded());
    CHECK(json["error"]["code"] == "usage");
  }
}

TEST_CASE("reconstructing twice gives identical bytes") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  for (const char* how :
       {"--basis identity --box 0,1", "--basis dct --nonnegative", "--precision f64", "--solver tikhonov",
        "--solver adm --basis haar", "--solver adm --as-published --nonnegative", "--solver cp --basis tv --box 0,1",
        "--solver fista", "--solver omp --basis dct", "--solver tsvd"}) {
    CAPTURE(how);
    const std::string command = std::string(small_eye) + "--sigma 0.002 " + how;
    CHECK(run_compueye(command + " --out first.npy --png first.png", folder.path()).exit_code == 0);
    CHECK(run_compueye(command + " --out second.npy --png second.png", folder.path()).exit_code == 0);
    CHECK(bytes_of(folder / "first.npy") == bytes_of(folder / "second.npy"));
    CHECK(bytes_of(folder / "first-0001.png") == bytes_of(folder / "second-0001.png"));
    CHECK(pictures_in(folder / "first.npy").size() == 512);
  }
}

TEST_CASE("frames with weights of their own equal single runs with these weights") {
  const TemporaryFolder folder;
  put_frames(folder, 3);
  const auto samples = firmware::read_samples(folder / "y.npy", 64);
  REQUIRE(samples.has_value());
  std::vector<double> weights(3 * 64, 1.0);
  for (std::size_t m = 0; m < 64; ++m) weights[64 + m] = m % 9 == 0 ? 0.0 : 1.0;
  for (std::size_t m = 0; m < 64; ++m) weights[128 + m] = 0.25 + 0.05 * static_cast<double>(m);
  put_npy(folder, "w.npy", {3, 64}, weights);
  const std::string how = "--weights w.npy --lambda 0.05 --box 0,1 --iterations 3000 ";
  const auto all = json_from(std::string(small_eye) + how + "--out all.npy --json", folder.path());
  CHECK(all["per_frame"][1]["channels_used"] == 56);
  const std::vector<double> together = pictures_in(folder / "all.npy");
  for (std::size_t f = 0; f < 3; ++f) {
    CAPTURE(f);
    const auto own = std::span(weights).subspan(64 * f, 64);
    put_npy(folder, "w.npy", {64}, {own.begin(), own.end()});
    const auto frame = samples->frame(static_cast<std::int64_t>(f));
    put_npy(folder, "y.npy", {64}, {frame.begin(), frame.end()});
    const auto one = json_from(std::string(small_eye) + how + "--out one.npy --json", folder.path());
    CHECK(one["per_frame"][0]["objective"].get<double>() ==
          doctest::Approx(all["per_frame"][f]["objective"].get<double>()).epsilon(1e-3));
    CHECK(relative_distance(std::span(together).subspan(256 * f, 256), pictures_in(folder / "one.npy")) < 1e-3);
  }
}

TEST_CASE("adm keeps the bound it is given, and as published it does not") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  const auto right = json_from(
      std::string(small_eye) + "--solver adm --nonnegative --epsilon 0.5 --iterations 2000 --json", folder.path());
  CHECK(right["objective"]["epsilon"] == 0.5);
  CHECK(right["health"]["converged"] == 2);
  for (const auto& frame : right["per_frame"]) {
    CHECK(frame["residual"].get<double>() == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(frame["duality_gap"].get<double>() < 0.01 * frame["objective"].get<double>());
  }
  const auto published = json_from(std::string(small_eye) +
                                       "--solver adm --as-published --nonnegative --epsilon 0.5 "
                                       "--iterations 2000 --json",
                                   folder.path());
  CHECK(published["operating_point"]["solver"] == "adm as published");
  for (const auto& frame : published["per_frame"]) CHECK(std::abs(frame["residual"].get<double>() - 0.5) > 0.1);
}

TEST_CASE("solvers that end by themselves say where: omp by its elements, tsvd by its rank") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const auto omp = json_from(std::string(small_eye) + "--solver omp --epsilon 0.01 --json", folder.path());
  CHECK(omp["per_frame"][0]["residual"].get<double>() <= 0.01);
  CHECK(omp["per_frame"][0]["iterations"].get<int>() <= 64);
  CHECK(omp["per_frame"][0]["iterations"].get<int>() >= 10);
  CHECK(omp["per_frame"][0]["duality_gap"].is_null());
  CHECK(omp["rho"].is_null());
  const auto few = json_from(std::string(small_eye) + "--solver tsvd --rank 20 --json", folder.path());
  const auto many = json_from(std::string(small_eye) + "--solver tsvd --rank 60 --json", folder.path());
  const auto by_noise = json_from(std::string(small_eye) + "--solver tsvd --sigma 1 --json", folder.path());
  CHECK(few["rank"] == 20);
  CHECK(many["median_residual"].get<double>() < 0.5 * few["median_residual"].get<double>());
  CHECK(by_noise["rank"].get<int>() > 10);
  CHECK(by_noise["rank"].get<int>() < 64);
  check_failed(run_compueye(std::string(small_eye) + "--solver tsvd --rank 65", folder.path()),
               hal::ErrorCode::out_of_range, "--rank", {"65", "1", "64"});
}

TEST_CASE("the operator is the one asked for, by rule the one that suits the response") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const std::string settings = std::string(small_eye) + "--sigma 0.002 --box 0,1 --iterations 300 ";
  const auto by_rule = json_from(settings + "--json", folder.path());
  CHECK(by_rule["operating_point"]["operator"] == "running sums, four rows at once");
  for (const auto& [word, meaning] : {std::pair{"dense", "dense"},
                                      {"csr", "csr"},
                                      {"running-sums", "running sums, four rows at once"},
                                      {"dense-runs", "dense runs"},
                                      {"dense-runs-bf16", "dense runs in bf16"},
                                      {"dense-runs-int8", "dense runs in int8"}}) {
    const auto asked = json_from(settings + "--operator " + word + " --json", folder.path());
    CHECK(asked["operating_point"]["operator"] == meaning);
    CHECK(asked["median_objective"].get<double>() ==
          doctest::Approx(by_rule["median_objective"].get<double>()).epsilon(0.05));
  }
}

TEST_CASE("threads change nothing of the picture") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const std::string settings = std::string(small_eye) + "--sigma 0.002 --box 0,1 --iterations 20 --json ";
  const auto alone = json_from(settings + "--out one.npy", folder.path());
  const auto shared = json_from(settings + "--threads 3 --out three.npy", folder.path());
  CHECK(pictures_in(folder / "one.npy") == pictures_in(folder / "three.npy"));
  CHECK(alone["median_objective"] == shared["median_objective"]);
}

TEST_CASE("the report has every figure") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  const auto json =
      json_from(std::string(small_eye) + "--truth truth.npy --sigma 0.002 --box 0,1 --iterations 50 --out x.npy --json",
                folder.path());
  for (const char* key : {"response",
                          "samples",
                          "weights",
                          "operating_point",
                          "objective",
                          "rho",
                          "relaxation",
                          "max_reweighted",
                          "rows",
                          "cols",
                          "channels",
                          "seeing_channels",
                          "frames",
                          "setup_s",
                          "median_frame_ms",
                          "table_bytes",
                          "workspace_bytes",
                          "median_objective",
                          "median_residual",
                          "health",
                          "quality",
                          "written",
                          "per_frame"}) {
    CAPTURE(key);
    CHECK(json.contains(key));
  }
  CHECK(json["objective"]["lambda_by"] == "rule");
  CHECK(json["objective"]["lambda"].get<double>() > 0.0);
  CHECK(json["objective"]["constraint"] == "box");
  CHECK(json["operating_point"]["iterations"] == 50);
  CHECK(json["frames"] == 2);
  CHECK(json["per_frame"].size() == 2);
  CHECK(json["rho"].get<double>() > 0.0);
  CHECK(json["health"]["invalid"] == 0);
  CHECK(json["quality"]["nmse"].get<double>() == doctest::Approx(0.5 * (json["per_frame"][0]["nmse"].get<double>() +
                                                                        json["per_frame"][1]["nmse"].get<double>())));
  CHECK(json["quality"]["ssim"].get<double>() < 1.0);

  const Outcome text =
      run_compueye(std::string(small_eye) + "--truth truth.npy --lambda 0.01 --nonnegative", folder.path());
  CHECK(text.exit_code == 0);
  for (const char* part : {"admm, identity basis", "by hand", "rho", "64 seeing channels of 64", "median", "objective",
                           "residual", "health", "NMSE", "PSNR", "SSIM"}) {
    CAPTURE(part);
    CHECK(text.out.find(part) != std::string::npos);
  }
}

TEST_CASE("pictures are written in the shape of the samples, in 8 bits as PNG") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const std::string command = std::string(small_eye) + "--sigma 0.002 --box 0,1 --out x.npy --png x.png";
  CHECK(run_compueye(command, folder.path()).exit_code == 0);
  const auto framed = firmware::read_npy(folder / "x.npy", 1, 3);
  REQUIRE(framed.has_value());
  CHECK(framed->shape == std::vector<std::int64_t>{1, 16, 16});
  const auto png = firmware::read_png(folder / "x.png");
  REQUIRE(png.has_value());
  CHECK(png->rows == 16);
  for (std::size_t i = 0; i < png->pixels.size(); ++i)
    CHECK(std::abs(png->pixels[i] - framed->values[i]) <= 0.5001 / 255);

  const auto y = firmware::read_samples(folder / "y.npy", 64);
  put_npy(folder, "y.npy", {64}, y->values);
  CHECK(run_compueye(command, folder.path()).exit_code == 0);
  const auto flat = firmware::read_npy(folder / "x.npy", 1, 3);
  REQUIRE(flat.has_value());
  CHECK(flat->shape == std::vector<std::int64_t>{16, 16});
  CHECK(flat->values == framed->values);
}

TEST_CASE("a frame that cannot be solved is black and counted, and the others are what they are without it") {
  const TemporaryFolder folder;
  put_frames(folder, 4);
  const std::string command = std::string(small_eye) + "--sigma 0.01 --iterations 20 --truth truth.npy --json ";
  REQUIRE(run_compueye(command + "--out sound.npy", folder.path()).exit_code == 0);
  const auto sound = pictures_in(folder.path() / "sound.npy");
  auto samples = firmware::read_samples(folder.path() / "y.npy", 64).value();
  const auto channels = static_cast<std::size_t>(samples.channels);
  for (std::size_t m = 0; m < channels; ++m) samples.values[m] = std::nan("");
  samples.values[2 * channels + 5] = 1e300;
  put_npy(folder, "y.npy", {4, samples.channels}, samples.values);
  for (const char* lambda : {"", "--lambda-from-samples"}) {
    CAPTURE(lambda);
    const auto json = json_from(command + "--out x.npy " + lambda, folder.path());
    CHECK(json["health"]["invalid"] == 2);
    CHECK(json["first_invalid"] == 0);
    CHECK(json["per_frame"][2]["health"] == "invalid");
    CHECK(json["median_objective"].get<double>() > 0.0);
    CHECK(json["quality"]["nmse"].get<double>() < 1.0);  // a black picture's
    const auto pictures = pictures_in(folder.path() / "x.npy");
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const bool black = k / 256 % 2 == 0;
      if (black || *lambda == '\0') CHECK(pictures[k] == (black ? 0.0 : sound[k]));
    }
  }
}

TEST_CASE("one truth serves every frame") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  const auto truths = pictures_in(folder / "truth.npy");
  put_npy(folder, "truth.npy", {16, 16}, {truths.begin(), truths.begin() + 256});
  const auto json = json_from(
      std::string(small_eye) + "--truth truth.npy --lambda 1e-3 --box 0,1 --iterations 2000 --json", folder.path());
  // The second frame is .8 of the first.
  CHECK(json["per_frame"][0]["nmse"].get<double>() < 0.01);
  CHECK(json["per_frame"][1]["nmse"].get<double>() == doctest::Approx(0.04).epsilon(0.1));
}

TEST_CASE("reconstruct --help states what goes with what and an example") {
  const TemporaryFolder folder;
  const Outcome help = run_compueye("reconstruct --help", folder.path());
  CHECK(help.exit_code == 0);
  CHECK(help.err.empty());
  for (const char* part :
       {"  admm      identity, dct, haar, db4, dft, tv   none, nonnegative, box\n",
        "  adm       identity                            none, nonnegative, box\n",
        "  adm       dct, haar, db4, dft                 none\n",
        "  tsvd      identity                            none\n", "numbered", "compueye reconstruct --response"}) {
    CAPTURE(part);
    CHECK(help.out.find(part) != std::string::npos);
  }
}

TEST_CASE("a start from cold is what every solver does, said or not") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  for (const auto& solver : recon::solver_names()) {
    CAPTURE(solver.name);
    const std::string command = std::string(small_eye) + "--sigma 0.002 --solver " + std::string(solver.name);
    CHECK(run_compueye(command + " --start cold", folder.path()).exit_code == 0);
    CHECK(run_compueye(command + " --start warm", folder.path()).exit_code == (solver.kind->starts_warm() ? 0 : 2));
  }
}

TEST_CASE("reconstruct --help names every solver, basis and form of A that there is") {
  const TemporaryFolder folder;
  const std::string help = run_compueye("reconstruct --help", folder.path()).out;
  const auto names = [&](std::string_view word) {
    CAPTURE(word);
    CHECK(std::regex_search(help, std::regex("[ ,]" + std::string(word) + "[ ,;)]")));
  };
  for (const auto& solver : recon::solver_names()) {
    names(solver.name);
    CHECK(help.find("\n  " + std::string(solver.name) + " ") != std::string::npos);  // what goes with what
  }
  for (const auto& basis : recon::basis_names()) names(basis.name);
  for (const auto& op : recon::operator_names()) names(op.name);
}

TEST_CASE("lambda from the samples is one of the rule's multiples, and says so") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  const std::string command = std::string(small_eye) + "--basis haar --box 0,1 --sigma 0.05 --truth truth.npy --json ";
  const auto rule = json_from(command + "--out rule.npy", folder.path());
  const auto risk = json_from(command + "--lambda-from-samples --out risk.npy", folder.path());
  CHECK(rule["objective"]["lambda_by"] == "rule");
  CHECK(risk["objective"]["lambda_by"] == "risk");
  const double multiple = risk["objective"]["lambda"].get<double>() / rule["objective"]["lambda"].get<double>();
  CHECK(std::abs(std::log2(multiple) - std::round(std::log2(multiple))) < 1e-6);
  const Outcome text =
      run_compueye(std::string(small_eye) + "--basis haar --box 0,1 --sigma 0.05 --lambda-from-samples --out again.npy",
                   folder.path());
  CHECK(text.out.find("by risk of the first frame") != std::string::npos);
  CHECK(pictures_in(folder / "again.npy") == pictures_in(folder / "risk.npy"));
}

TEST_CASE("lambda from the samples needs their noise, and does without missing channels") {
  const TemporaryFolder folder;
  put_frames(folder, 2);
  check_failed(run_compueye(std::string(small_eye) + "--lambda 1 --lambda-from-samples --out x.npy", folder.path()),
               hal::ErrorCode::usage, "--lambda-from-samples", {"--sigma"});
  CHECK_FALSE(std::filesystem::exists(folder / "x.npy"));
  std::vector<double> weights(128, 1.0);
  weights[5] = 0.0;
  put_npy(folder, "w.npy", {2, 64}, weights);
  const auto json = json_from(
      std::string(small_eye) + "--sigma 0.1 --lambda-from-samples --weights w.npy --json --out x.npy", folder.path());
  CHECK(json["objective"]["lambda_by"] == "risk");
}

TEST_CASE("reweighting makes a pixel-sparse picture better, and is refused elsewhere") {
  const TemporaryFolder folder;
  put_frames(folder, 1);
  const std::string command = std::string(small_eye) + "--sigma 0.02 --box 0,1 --truth truth.npy --out x.npy ";
  const auto nmse = [&](std::string_view more) {
    return json_from(command + "--json " + std::string(more), folder.path())["per_frame"][0]["nmse"].get<double>();
  };
  CHECK(nmse("--reweight 0.1") < 0.5 * nmse(""));
  check_failed(run_compueye(command + "--reweight 0.1 --basis dct", folder.path()), hal::ErrorCode::usage, "--reweight",
               {"identity"});
  check_failed(run_compueye(command + "--reweight 0.1 --solver fista", folder.path()), hal::ErrorCode::usage,
               "--reweight", {"admm"});
  check_failed(run_compueye(command + "--reweight 0", folder.path()), hal::ErrorCode::usage, "--reweight", {"0"});
}
