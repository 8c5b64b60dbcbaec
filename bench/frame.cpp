// Where the time of a frame goes: each part of one ADMM iteration (DCT and box) on the 8x8 and the 80x80 eye, what it
// moves and computes, and how near that comes to the bandwidth at which this machine reads memory.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/core/bases/dct.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/basis_tables.hpp"
#include "recon/setup/inverse_tables.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/operator_list.hpp"

using namespace compueye;
namespace core = recon::core;

namespace {

constexpr int many = 41;  // iterations of the longer of the two frames that the whole iteration is timed by

struct Part {
  std::string name;
  double ms = 0.0;
  double bytes = 0.0;  // tables and vectors read and written once, whatever the caches keep
  double flops = 0.0;
};

/// What core::FrameProblem points at inside a Reconstructor, once more, for its parts to be called one by one.
struct Operator {
  recon::KeptTables tables;
  core::LinearOperator<float> a;
  std::optional<recon::AlignedWorkspace> memory;

  explicit Operator(const recon::Response& seeing) {
    a = recon::make_operator<float>(seeing, std::nullopt, tables).value();
    memory.emplace(view().scratch_size() * sizeof(float) + 64);
  }
  [[nodiscard]] const core::LinearOperator<float>& view() const { return a; }
  [[nodiscard]] float* scratch() const { return reinterpret_cast<float*>(memory->span().data()); }

  /// Multiplications and additions of one application.
  [[nodiscard]] double flops() const { return 2.0 * static_cast<double>(core::flops(view())); }
};

std::vector<float> some_numbers(std::size_t count) {
  std::vector<float> v(count);
  for (std::size_t k = 0; k < count; ++k) v[k] = static_cast<float>((k * 37) % 101) / 101.0F - 0.3F;
  return v;
}

/// Multiplications and additions of one 1-D transform of this length.
double transform_flops(std::size_t length) {
  using Table = core::DctTable<float>;
  double flops = 0.0;
  while (length % 2 == 0) {
    flops += static_cast<double>(length);
    length /= 2;
    const std::size_t products = Table::rotated(length) ? 2 * Table::halving_size(length / 2) : length * length;
    flops += 2.0 * static_cast<double>(products) + (Table::rotated(length) ? 4.0 * static_cast<double>(length) : 0.0);
  }
  return flops + 2.0 * static_cast<double>(length * length);
}

Part measure_forward(Operator& a) {
  const auto x = some_numbers(a.view().cols);
  std::vector<float> y(a.view().rows);
  const double vectors = 4.0 * static_cast<double>(a.view().cols + a.view().rows);
  return {"A forward", bench::median_ms([&] { core::forward(a.view(), x.data(), y.data(), a.scratch()); }),
          static_cast<double>(a.tables.bytes()) + vectors, a.flops()};
}

Part measure_adjoint(Operator& a) {
  const auto y = some_numbers(a.view().rows);
  std::vector<float> x(a.view().cols);
  const double vectors = 4.0 * static_cast<double>(2 * a.view().cols + a.view().rows);
  const auto work = [&] {
    std::fill(x.begin(), x.end(), 0.0F);  // or the sums would run away
    core::adjoint_accumulate(a.view(), y.data(), x.data(), a.scratch());
  };
  return {"A adjoint", bench::median_ms(work), static_cast<double>(a.tables.bytes()) + vectors, a.flops()};
}

Part measure_inverse(const recon::Response& seeing, const recon::Factor& factor) {
  recon::KeptTables kept;
  const recon::ParityClasses classes(seeing.rows(), recon::find_mirror_symmetry(seeing));
  const auto h = recon::make_inverse(classes, {}, factor.values.data(), kept);
  const auto x = some_numbers(h.order);
  std::vector<float> y(h.order), scratch(h.scratch_size());
  const auto entries = static_cast<double>(factor.values.size());
  const auto shares = static_cast<double>(h.classes > 1 ? h.classes * h.order : 0);
  return {"inverse product", bench::median_ms([&] { core::multiply(h, x.data(), y.data(), scratch.data()); }),
          4.0 * (entries + 2.0 * static_cast<double>(h.order)) + 2.0 * 8.0 * shares, 4.0 * (entries + shares)};
}

Part measure_dct(int rows, int cols) {
  const auto row_table = recon::make_dct_table<float>(rows), col_table = recon::make_dct_table<float>(cols);
  const auto height = static_cast<std::size_t>(rows), width = static_cast<std::size_t>(cols);
  const core::Dct2d<float> psi{{height, row_table.data()}, {width, col_table.data()}};
  std::vector<float> scratch(core::dct_scratch_size(height, width));
  auto picture = some_numbers(height * width);
  const auto work = [&] {
    core::dct_forward(psi, picture.data(), picture.data(), scratch.data());
    core::dct_inverse(psi, picture.data(), picture.data(), scratch.data());
  };
  // Two passes each way, which read and write the picture.
  const double pixels = static_cast<double>(rows) * cols;
  return {"DCT there and back", bench::median_ms(work),
          4.0 * (8.0 * pixels + 2.0 * static_cast<double>(row_table.size() + col_table.size())),
          2.0 * (cols * transform_flops(height) + rows * transform_flops(width))};
}

Part measure_proximal(std::size_t n) {
  const auto x = some_numbers(n), coefficients = some_numbers(n);
  std::vector<float> z(n), u(n), zp(n), up(n), out(n);
  const auto work = [&] {
    core::subtract(z.data(), u.data(), out.data(), n);
    core::blend_difference(zp.data(), up.data(), 0.5F, out.data(), n);
    core::flush_tiny(out.data(), n);
    core::relaxed_prox_step(coefficients.data(), z.data(), u.data(), n, 1.7F, 0.01F, -1e30F, 1e30F);
    core::relaxed_prox_step(x.data(), zp.data(), up.data(), n, 1.7F, 0.0F, 0.0F, 1.0F);
  };
  // Vectors read and written: 2+1, 3+1, 1+1, and twice 3+2; operations an element: 1, 4, 0, and twice 9.
  return {"proximal updates", bench::median_ms(work), 4.0 * 19.0 * static_cast<double>(n),
          23.0 * static_cast<double>(n)};
}

/// One iteration by the difference of two frames, so that what a frame costs once drops out.
hal::Result<Part> measure_whole(const recon::Response& response, const recon::Objective& objective, recon::Plan plan,
                                const recon::Factor& factor) {
  double ms[2] = {};
  const auto y = some_numbers(static_cast<std::size_t>(response.rows()));
  std::vector<float> x(static_cast<std::size_t>(response.cols()));
  for (const int longer : {0, 1}) {
    plan.iterations = longer == 1 ? many : 1;
    const auto solver = recon::Reconstructor::create(response, objective, plan, factor);
    if (!solver) return tl::unexpected(solver.error());
    const recon::AlignedWorkspace workspace(solver->required_bytes());
    ms[longer] = bench::median_ms([&] { static_cast<void>(solver->solve(y, {}, workspace.span(), x)); });
  }
  return Part{"whole iteration", (ms[1] - ms[0]) / (many - 1), 0.0, 0.0};
}

hal::Result<std::vector<Part>> measure(const bench::Eye& eye) {
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.max_reweighted = 0;
  const auto solver = recon::Reconstructor::create(*response, objective, plan);
  if (!solver) return tl::unexpected(solver.error());
  const recon::Response seeing = response->select_rows(response->seeing_rows());
  Operator a(seeing);
  std::vector<Part> parts{measure_forward(a), measure_adjoint(a), measure_inverse(seeing, solver->factor()),
                          measure_dct(eye.plane.rows, eye.plane.cols), measure_proximal(a.view().cols)};
  auto whole = measure_whole(*response, objective, solver->plan(), solver->factor());
  if (!whole) return tl::unexpected(whole.error());
  for (const Part& part : parts) {
    whole->bytes += part.bytes;
    whole->flops += part.flops;
  }
  parts.push_back(*whole);
  return parts;
}

double gigabytes_per_second(const Part& part) {
  return part.bytes / part.ms * 1e-6;
}

std::string table_text(const bench::Eye& eye, const std::vector<Part>& parts, double bandwidth) {
  firmware::Table table({{std::string(eye.name), firmware::Align::left},
                         {"us"},
                         {"share"},
                         {"kB moved"},
                         {"kflop"},
                         {"GB/s"},
                         {"of read bandwidth"},
                         {"Gflop/s"}});
  for (const Part& part : parts) {
    table.add({part.name, fmt::format("{:.1f}", 1e3 * part.ms),
               fmt::format("{:.1f} %", 100.0 * part.ms / parts.back().ms), fmt::format("{:.0f}", part.bytes * 1e-3),
               fmt::format("{:.0f}", part.flops * 1e-3), fmt::format("{:.2f}", gigabytes_per_second(part)),
               fmt::format("{:.0f} %", 100.0 * gigabytes_per_second(part) / bandwidth),
               fmt::format("{:.2f}", part.flops / part.ms * 1e-6)});
  }
  return table.text() + "\n";
}

bench::Json json_of(const bench::Eye& eye, const std::vector<Part>& parts) {
  bench::Json json;
  json["eye"] = eye.name;
  for (const Part& part : parts) {
    json["parts"].push_back({{"name", part.name},
                             {"ms", part.ms},
                             {"bytes", part.bytes},
                             {"flops", part.flops},
                             {"gigabytes_per_second", gigabytes_per_second(part)}});
  }
  return json;
}

/// The parts of a frame on both eyes.
struct Measured {
  double bandwidth = 0.0;
  std::vector<std::pair<bench::Eye, std::vector<Part>>> eyes;
};

hal::Result<Measured> measure_all() {
  Measured measured{bench::read_bandwidth(), {}};
  for (const bench::Eye& eye : {bench::eye_8x8(), bench::eye_80x80()}) {
    auto parts = measure(eye);
    if (!parts) return tl::unexpected(std::move(parts.error()));
    measured.eyes.emplace_back(eye, std::move(*parts));
  }
  return measured;
}

std::string whole_text(const Measured& measured) {
  std::string text = fmt::format("one core reads memory at {:.2f} GB/s\n\n", measured.bandwidth);
  for (const auto& [eye, parts] : measured.eyes) text += table_text(eye, parts, measured.bandwidth);
  return text;
}

std::string whole_json(const Measured& measured) {
  bench::Json json;
  json["read_bandwidth_gigabytes_per_second"] = measured.bandwidth;
  for (const auto& [eye, parts] : measured.eyes) json["eyes"].push_back(json_of(eye, parts));
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_frame", measure_all, whole_text, whole_json);
}
