// What going on from the last frame is worth: NMSE after K iterations, warm and cold, over sequences of frames of the
// 80x80 eye: one that stands still, one with a moving block, one that is panned, and one that is cut to another picture
// every fifth frame. y = A x + n with fresh noise in every frame; lambda by rule from the noise.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"

using namespace compueye;

namespace {

constexpr int frames = 15;
constexpr int settling = 5;  // frames before the first that counts

using Picture = std::vector<float>;

Picture drawn(const std::string& scene, const bench::Eye& eye, std::uint64_t seed) {
  return sim::render_built_in(scene, eye.plane.rows, eye.plane.cols, seed).value().pixels;
}

Picture panned(const Picture& picture, int cols, int by) {
  Picture out(picture.size());
  for (std::size_t k = 0; k < picture.size(); ++k) {
    const int row = static_cast<int>(k) / cols, col = static_cast<int>(k) % cols;
    out[k] = picture[static_cast<std::size_t>(row * cols + (col + by) % cols)];
  }
  return out;
}

/// A grey block of a tenth of the width.
Picture with_block(Picture picture, int cols, int at) {
  const int side = cols / 10;
  for (int r = 0; r < side; ++r) {
    for (int c = 0; c < side; ++c) {
      picture[static_cast<std::size_t>((cols / 2 + r) * cols + (at + c) % cols)] = 0.5F;
    }
  }
  return picture;
}

std::vector<Picture> sequence(const std::string& motion, const std::string& scene, const bench::Eye& eye) {
  const Picture base = drawn(scene, eye, 200);
  std::vector<Picture> pictures;
  for (int f = 0; f < frames; ++f) {
    if (motion == "still") pictures.push_back(base);
    if (motion == "block") pictures.push_back(with_block(base, eye.plane.cols, 20 + 2 * f));
    if (motion == "pan") pictures.push_back(panned(base, eye.plane.cols, f));
    if (motion == "cuts") pictures.push_back(drawn(scene, eye, 200 + static_cast<std::uint64_t>(f / 5)));
  }
  return pictures;
}

double nmse(const Picture& truth, const Picture& x) {
  double squares = 0.0, errors = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = static_cast<double>(truth[k]), d = static_cast<double>(x[k]) - t;
    squares += t * t;
    errors += d * d;
  }
  return errors / squares;
}

struct Line {
  std::string scene, motion;
  double sigma = 0.0;
  int iterations = 0;
  double cold = 0.0, warm = 0.0;  ///< mean NMSE
  double worst = 0.0;             ///< largest warm / cold of a frame
  int warm_frames = 0, counted = 0;
};

/// Mean NMSE of a sequence; `each` gets every counted frame's.
std::pair<double, int> mean_nmse(const recon::Reconstructor& solver, const std::vector<std::vector<float>>& samples,
                                 const std::vector<Picture>& truth, std::vector<double>& each) {
  const recon::AlignedWorkspace memory(solver.required_bytes());
  std::fill(memory.span().begin(), memory.span().end(), std::byte{0});
  Picture x(truth.front().size());
  double sum = 0.0;
  int warm = 0;
  for (std::size_t f = 0; f < samples.size(); ++f) {
    const recon::FrameInfo info = solver.solve(samples[f], {}, memory.span(), x);
    if (f < settling) continue;
    each.push_back(nmse(truth[f], x));
    sum += each.back();
    warm += info.warm ? 1 : 0;
  }
  return {sum / static_cast<double>(each.size()), warm};
}

hal::Result<std::vector<Line>> measure() {
  const bench::Eye eye = bench::eye_80x80();
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  std::vector<Line> lines;
  std::optional<recon::Factor> factor;
  for (const auto& [scene, basis] : {std::pair{"line-art", recon::BasisKind::dct}, {"phantom", recon::BasisKind::tv}}) {
    for (const double sigma : {bench::read_noise, 3.0}) {
      recon::Objective objective;
      objective.basis = basis;
      objective.constraint = recon::ConstraintKind::box;
      objective.lambda = recon::lambda_by_rule(*response, recon::solver_named("pdhg"), basis, sigma).value();
      recon::Plan plan;
      plan.solver = recon::solver_named("pdhg");
      auto cold = recon::Reconstructor::create(*response, objective, plan, factor);
      if (!cold) return tl::unexpected(cold.error());
      factor = cold->factor();
      plan.warm_start = true;
      auto warm = recon::Reconstructor::create(*response, objective, plan, factor);
      if (!warm) return tl::unexpected(warm.error());
      for (const char* motion : {"still", "block", "pan", "cuts"}) {
        const auto truth = sequence(motion, scene, eye);
        std::vector<std::vector<float>> samples;
        for (std::size_t f = 0; f < truth.size(); ++f) {
          std::vector<double> signal(static_cast<std::size_t>(response->rows()));
          response->forward(std::vector<double>(truth[f].begin(), truth[f].end()), signal);
          samples.emplace_back();
          for (std::size_t m = 0; m < signal.size(); ++m) {
            sim::RandomStream stream({f, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
            samples.back().push_back(static_cast<float>(signal[m] + sigma * stream.gaussian()));
          }
        }
        for (const int iterations : {3, 5, 8, 20}) {
          if (!cold->set_iterations(iterations) || !warm->set_iterations(iterations)) continue;
          Line line{scene, motion, sigma, iterations, 0.0, 0.0, 0.0, 0, 0};
          std::vector<double> of_cold, of_warm;
          line.cold = mean_nmse(*cold, samples, truth, of_cold).first;
          std::tie(line.warm, line.warm_frames) = mean_nmse(*warm, samples, truth, of_warm);
          line.counted = static_cast<int>(of_warm.size());
          for (std::size_t f = 0; f < of_warm.size(); ++f) line.worst = std::max(line.worst, of_warm[f] / of_cold[f]);
          lines.push_back(line);
        }
      }
    }
  }
  return lines;
}

std::string table_text(const std::vector<Line>& lines) {
  firmware::Table table({{"80x80", firmware::Align::left},
                         {"motion", firmware::Align::left},
                         {"sigma"},
                         {"iterations"},
                         {"NMSE cold"},
                         {"warm"},
                         {"worst warm / cold"},
                         {"warm frames"}});
  for (const Line& l : lines) {
    table.add({l.scene, l.motion, fmt::format("{:.3g}", l.sigma), std::to_string(l.iterations),
               fmt::format("{:.4f}", l.cold), fmt::format("{:.4f}", l.warm), fmt::format("{:.2f}", l.worst),
               fmt::format("{} of {}", l.warm_frames, l.counted)});
  }
  return table.text() + "\n";
}

std::string json_of(const std::vector<Line>& lines) {
  bench::Json json = bench::Json::array();
  for (const Line& l : lines) {
    json.push_back({{"scene", l.scene},
                    {"motion", l.motion},
                    {"sigma", l.sigma},
                    {"iterations", l.iterations},
                    {"nmse_cold", l.cold},
                    {"nmse_warm", l.warm},
                    {"worst_ratio", l.worst},
                    {"warm_frames", l.warm_frames},
                    {"frames", l.counted}});
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_warm_start", measure, table_text, json_of);
}
