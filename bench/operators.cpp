// How fast A and A' are applied: every representation of ours, and Eigen's, on the same eyes in the same run. One core.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/eigen_baseline.hpp"
#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "calib/plausible_response.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/running_sum_tables.hpp"

using namespace compueye;
namespace core = recon::core;

namespace {

struct Timed {
  std::string name;
  double forward_us = 0.0;
  double adjoint_us = 0.0;
  double bytes = 0.0;  ///< of tables, read once an application
  double flops = 0.0;  ///< multiply-adds of one application
  double taps = 0.0;   ///< table entries of one application, each for one or more rows; 0: Eigen's own business
  bool baseline = false;
};

using Apply = std::function<void()>;

Timed time(std::string name, const Apply& forward, const Apply& adjoint) {
  return {std::move(name), 1e3 * bench::median_ms(forward), 1e3 * bench::median_ms(adjoint)};
}

std::vector<float> some_numbers(std::size_t count) {
  std::vector<float> v(count);
  for (std::size_t k = 0; k < count; ++k) v[k] = static_cast<float>((k * 37) % 101) / 101.0F;
  return v;
}

/// Vectors that every representation works on.
struct Vectors {
  explicit Vectors(const recon::Response& a)
      : x(some_numbers(static_cast<std::size_t>(a.cols()))),
        y(some_numbers(static_cast<std::size_t>(a.rows()))),
        x_out(x.size()),
        y_out(y.size()) {}
  std::vector<float> x, y, x_out, y_out;
};

Timed time_eigen(const std::string& name, const bench::EigenBaseline& eigen, const recon::Response& a, Vectors& v) {
  Timed timed = time(
      name, [&] { eigen.forward(v.x, v.y_out); }, [&] { eigen.adjoint(v.y, v.x_out); });
  timed.bytes = eigen.bytes();
  timed.flops = static_cast<double>(a.nonzeros());
  timed.baseline = true;
  return timed;
}

/// Table entries that a vector of rows shares count once.
double taps_of(const core::LinearOperator<float>& a) {
  const core::RunningSums<float>& sums = a.sums;
  return static_cast<double>(sums.tables > 0 ? sums.first[4 * sums.tables * sums.bands] : core::flops(a));
}

Timed time_ours(const std::string& name, const core::LinearOperator<float>& op, Vectors& v) {
  const recon::AlignedWorkspace memory(op.scratch_size() * sizeof(float) + 64);
  auto* scratch = reinterpret_cast<float*>(memory.span().data());
  Timed timed = time(
      name, [&] { core::forward(op, v.x.data(), v.y_out.data(), scratch); },
      [&] {
        std::fill(v.x_out.begin(), v.x_out.end(), 0.0F);
        core::adjoint_accumulate(op, v.y.data(), v.x_out.data(), scratch);
      });
  timed.bytes = static_cast<double>(core::bytes(op));
  timed.flops = static_cast<double>(core::flops(op));
  timed.taps = taps_of(op);
  return timed;
}

hal::Result<Timed> time_kind(const std::string& name, const recon::Response& a, recon::OperatorKind kind, Vectors& v) {
  recon::KeptTables kept;
  return recon::make_operator<float>(recon::quantised(a, kind), kind, kept).map([&](const auto& op) {
    return time_ours(name, op, v);
  });
}

/// Running sums with fewer rows at once than the response would let them have.
Timed time_running_sums(const std::string& name, const recon::Response& a, const recon::MirrorSymmetry& images,
                        const std::vector<std::int32_t>& transposed, Vectors& v) {
  const auto sums = *recon::running_sum_tables<float>(a, images, transposed);
  core::LinearOperator<float> op;
  op.kind = recon::OperatorKind::running_sums;
  op.rows = static_cast<std::size_t>(a.rows());
  op.cols = static_cast<std::size_t>(a.cols());
  op.sums = sums.view;
  return time_ours(name, op, v);
}

hal::Result<std::vector<Timed>> measure_plain(const recon::Response& a, Vectors& v) {
  std::vector<Timed> all;
  all.push_back(time_eigen("Eigen CSR", *bench::eigen_plain(a, bench::EigenStorage::csr), a, v));
  all.push_back(time_eigen("Eigen CSR, fast-math", *bench::eigen_fast_math(a, bench::EigenStorage::csr), a, v));
  std::vector<std::pair<std::string, recon::OperatorKind>> kinds{{"CSR", recon::OperatorKind::csr}};
  if (a.rows() < 1000) {
    all.push_back(time_eigen("Eigen dense", *bench::eigen_plain(a, bench::EigenStorage::dense), a, v));
    all.push_back(time_eigen("Eigen dense, fast-math", *bench::eigen_fast_math(a, bench::EigenStorage::dense), a, v));
    kinds.emplace_back("dense", recon::OperatorKind::dense);
  }
  kinds.emplace_back("dense runs", recon::OperatorKind::dense_runs);
  kinds.emplace_back("dense runs, bf16", recon::OperatorKind::dense_runs_bf16);
  kinds.emplace_back("dense runs, int8", recon::OperatorKind::dense_runs_int8);
  kinds.emplace_back("wavelet runs", recon::OperatorKind::wavelet_runs);
  for (const auto& [name, kind] : kinds) {
    auto timed = time_kind(name, a, kind, v);
    if (!timed) return tl::unexpected(std::move(timed.error()));
    all.push_back(std::move(*timed));
  }
  return all;
}

hal::Result<std::vector<Timed>> measure_nominal(const bench::Eye& eye) {
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  const recon::Response a = response->select_rows(response->seeing_rows());
  Vectors v(a);
  auto all = measure_plain(a, v);
  if (!all) return all;
  const recon::MirrorSymmetry images = recon::find_mirror_symmetry(a);
  const recon::MirrorSymmetry none{{images.permutations.front()}, {{1}}};
  const auto transposed = recon::find_diagonal_symmetry(a);
  all->push_back(time_running_sums("running sums, no symmetry", a, none, {}, v));
  all->push_back(time_running_sums("running sums, four rows at once", a, images, {}, v));
  all->push_back(time_running_sums("running sums, eight rows at once", a, images, transposed, v));
  return all;
}

/// Rows as a calibration might find them.
hal::Result<std::vector<Timed>> measure_measured(const bench::Eye& eye) {
  const auto response = calib::plausible_response(eye.geometry, eye.plane, {}, 1);
  if (!response) return tl::unexpected(response.error());
  const recon::Response a = response->select_rows(response->seeing_rows());
  Vectors v(a);
  return measure_plain(a, v);
}

double best(const std::vector<Timed>& all, double Timed::*figure, bool fast_math) {
  double least = 1e300;
  for (const Timed& timed : all) {
    const bool fast = timed.name.find("fast-math") != std::string::npos;
    if (timed.baseline && fast == fast_math) least = std::min(least, timed.*figure);
  }
  return least;
}

std::string ratios(const std::vector<Timed>& all, const Timed& timed, bool fast_math) {
  return fmt::format("{:.1f} / {:.1f}", best(all, &Timed::forward_us, fast_math) / timed.forward_us,
                     best(all, &Timed::adjoint_us, fast_math) / timed.adjoint_us);
}

/// Share of the memory bandwidth that reading the tables once takes, were they in no cache.
std::string share(double bytes, double us, double bandwidth) {
  return fmt::format("{:.0f} %", 100.0 * bytes / us * 1e-3 / bandwidth);
}

/// Every representation of an eye.
struct MeasuredEye {
  std::string name;
  std::vector<Timed> timed;
};

struct Measured {
  double bandwidth = 0.0;
  std::vector<MeasuredEye> eyes;
};

std::string table_text(const MeasuredEye& eye, double bandwidth) {
  firmware::Table table({{eye.name, firmware::Align::left},
                         {"A us"},
                         {"A' us"},
                         {"tables kB"},
                         {"k multiply-adds"},
                         {"ns a tap"},
                         {"of bandwidth"},
                         {"faster than Eigen (A / A')"},
                         {"than Eigen with fast-math"}});
  for (const Timed& t : eye.timed) {
    table.add(
        {t.name, fmt::format("{:.2f}", t.forward_us), fmt::format("{:.2f}", t.adjoint_us),
         fmt::format("{:.0f}", t.bytes * 1e-3), fmt::format("{:.0f}", t.flops * 1e-3),
         t.taps > 0.0 ? fmt::format("{:.2f} / {:.2f}", 1e3 * t.forward_us / t.taps, 1e3 * t.adjoint_us / t.taps) : "",
         share(t.bytes, t.forward_us, bandwidth) + " / " + share(t.bytes, t.adjoint_us, bandwidth),
         ratios(eye.timed, t, false), ratios(eye.timed, t, true)});
  }
  return table.text() + "\n";
}

bench::Json json_of(const MeasuredEye& eye, double bandwidth) {
  bench::Json json;
  json["eye"] = eye.name;
  for (const Timed& t : eye.timed) {
    json["representations"].push_back({{"name", t.name},
                                       {"forward_us", t.forward_us},
                                       {"adjoint_us", t.adjoint_us},
                                       {"table_bytes", t.bytes},
                                       {"multiply_adds", t.flops},
                                       {"taps", t.taps},
                                       {"forward_share_of_bandwidth", t.bytes / t.forward_us * 1e-3 / bandwidth},
                                       {"adjoint_share_of_bandwidth", t.bytes / t.adjoint_us * 1e-3 / bandwidth},
                                       {"baseline", t.baseline}});
  }
  return json;
}

hal::Result<Measured> measure_all() {
  Measured measured{bench::read_bandwidth(), {}};
  for (const bench::Eye& eye : {bench::eye_8x8(), bench::eye_80x80()}) {
    for (const bool nominal : {true, false}) {
      auto timed = nominal ? measure_nominal(eye) : measure_measured(eye);
      if (!timed) return tl::unexpected(std::move(timed.error()));
      measured.eyes.push_back({std::string(eye.name) + (nominal ? "" : ", measured rows"), std::move(*timed)});
    }
  }
  return measured;
}

std::string whole_text(const Measured& measured) {
  std::string text = fmt::format("one core reads memory at {:.2f} GB/s\n\n", measured.bandwidth);
  for (const MeasuredEye& eye : measured.eyes) text += table_text(eye, measured.bandwidth);
  return text;
}

std::string whole_json(const Measured& measured) {
  bench::Json json;
  json["read_bandwidth_gigabytes_per_second"] = measured.bandwidth;
  for (const MeasuredEye& eye : measured.eyes) json["eyes"].push_back(json_of(eye, measured.bandwidth));
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_operators", measure_all, whole_text, whole_json);
}
