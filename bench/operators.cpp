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
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "firmware/app/report/json_report.hpp"
#include "firmware/app/report/table.hpp"
#include "recon/core/linear_operator.hpp"
#include "recon/core/vector_sums.hpp"
#include "recon/problem_tables.hpp"
#include "recon/running_sum_tables.hpp"

using namespace compueye;
namespace core = recon::core;

namespace {

struct Timed {
  std::string name;
  double forward_us = 0.0;
  double adjoint_us = 0.0;
  double table_bytes = 0.0;
  double taps = 0.0;  ///< multiplications of one application, a vector of lanes counting once
  bool baseline = false;
};

using Apply = std::function<void()>;

Timed time(std::string name, const Apply& forward, const Apply& adjoint, double table_bytes, double taps) {
  return {std::move(name), 1e3 * bench::median_ms(forward), 1e3 * bench::median_ms(adjoint), table_bytes, taps, false};
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

Timed time_eigen(const std::string& name, const bench::EigenBaseline& eigen, Vectors& v) {
  Timed timed = time(
      name, [&] { eigen.forward(v.x, v.y_out); }, [&] { eigen.adjoint(v.y, v.x_out); }, eigen.bytes(), 0.0);
  timed.baseline = true;
  return timed;
}

Timed time_running_sums(const std::string& name, const recon::Response& a, const bench::Eye& eye,
                        const recon::MirrorSymmetry& images, Vectors& v) {
  const auto tables = recon::running_sum_tables<float>(a, eye.plane.rows, eye.plane.cols, images);
  const bench::Workspace memory(tables->view.scratch_size() * sizeof(float));
  auto* scratch = reinterpret_cast<float*>(memory.span().data());
  return time(
      name, [&] { core::forward(tables->view, v.x.data(), v.y_out.data(), scratch); },
      [&] {
        std::fill(v.x_out.begin(), v.x_out.end(), 0.0F);
        core::adjoint_accumulate(tables->view, v.y.data(), v.x_out.data(), scratch);
      },
      static_cast<double>(tables->bytes()), static_cast<double>(tables->element.size()));
}

/// Our plain forms, which serve as references.
Timed time_plain(const std::string& name, const recon::Response& a, recon::OperatorKind kind, Vectors& v) {
  std::vector<float> values;
  std::vector<std::uint32_t> row_start{0};
  std::vector<std::int32_t> columns;
  const auto cols = static_cast<std::size_t>(a.cols());
  for (int m = 0; m < a.rows(); ++m) {
    if (kind == recon::OperatorKind::dense) values.resize(values.size() + cols, 0.0F);
    a.for_each_in_row(m, [&](std::int32_t n, double entry) {
      if (kind == recon::OperatorKind::dense) {
        values[static_cast<std::size_t>(m) * cols + static_cast<std::size_t>(n)] = static_cast<float>(entry);
      } else {
        values.push_back(static_cast<float>(entry));
        columns.push_back(n);
      }
    });
    row_start.push_back(static_cast<std::uint32_t>(values.size()));
  }
  const core::LinearOperator<float> op{
      kind, static_cast<std::size_t>(a.rows()), cols, values.data(), row_start.data(), columns.data(), {}};
  return time(
      name, [&] { core::forward(op, v.x.data(), v.y_out.data(), nullptr); },
      [&] {
        std::fill(v.x_out.begin(), v.x_out.end(), 0.0F);
        core::adjoint_accumulate(op, v.y.data(), v.x_out.data(), nullptr);
      },
      4.0 * static_cast<double>(values.size() + columns.size()), static_cast<double>(values.size()));
}

hal::Result<std::vector<Timed>> measure(const bench::Eye& eye) {
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  const recon::Response a = response->select_rows(response->seeing_rows());
  Vectors v(a);
  std::vector<Timed> all;
  all.push_back(time_eigen("Eigen CSR", *bench::eigen_plain(a, bench::EigenStorage::csr), v));
  all.push_back(time_eigen("Eigen CSR, fast-math", *bench::eigen_fast_math(a, bench::EigenStorage::csr), v));
  const bool small = a.rows() < 1000;
  if (small) {
    all.push_back(time_eigen("Eigen dense", *bench::eigen_plain(a, bench::EigenStorage::dense), v));
    all.push_back(time_eigen("Eigen dense, fast-math", *bench::eigen_fast_math(a, bench::EigenStorage::dense), v));
    all.push_back(time_plain("dense", a, recon::OperatorKind::dense, v));
  }
  all.push_back(time_plain("CSR", a, recon::OperatorKind::csr, v));
  const recon::MirrorSymmetry images = recon::find_mirror_symmetry(a, eye.plane.rows, eye.plane.cols);
  const recon::MirrorSymmetry none{{images.permutations.front()}, {{1}}};
  all.push_back(time_running_sums("running sums, no symmetry", a, eye, none, v));
  all.push_back(time_running_sums("running sums, four rows at once", a, eye, images, v));
  return all;
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

std::string table_text(const bench::Eye& eye, const std::vector<Timed>& all) {
  firmware::Table table({{std::string(eye.name), firmware::Align::left},
                         {"A us"},
                         {"A' us"},
                         {"tables kB"},
                         {"ns a tap"},
                         {"GB/s"},
                         {"faster than Eigen (A / A')"},
                         {"than Eigen with fast-math"}});
  for (const Timed& t : all) {
    table.add(
        {t.name, fmt::format("{:.2f}", t.forward_us), fmt::format("{:.2f}", t.adjoint_us),
         fmt::format("{:.0f}", t.table_bytes * 1e-3),
         t.taps > 0.0 ? fmt::format("{:.2f} / {:.2f}", 1e3 * t.forward_us / t.taps, 1e3 * t.adjoint_us / t.taps) : "",
         fmt::format("{:.1f} / {:.1f}", t.table_bytes / t.forward_us * 1e-3, t.table_bytes / t.adjoint_us * 1e-3),
         ratios(all, t, false), ratios(all, t, true)});
  }
  return table.text() + "\n";
}

firmware::Json json_of(const bench::Eye& eye, const std::vector<Timed>& all) {
  firmware::Json json;
  json["eye"] = eye.name;
  for (const Timed& t : all) {
    json["representations"].push_back({{"name", t.name},
                                       {"forward_us", t.forward_us},
                                       {"adjoint_us", t.adjoint_us},
                                       {"table_bytes", t.table_bytes},
                                       {"taps", t.taps},
                                       {"baseline", t.baseline}});
  }
  return json;
}

/// Every representation of both eyes.
struct Measured {
  double bandwidth = 0.0;
  std::vector<std::pair<bench::Eye, std::vector<Timed>>> eyes;
};

hal::Result<Measured> measure_all() {
  Measured measured{bench::read_bandwidth(), {}};
  for (const bench::Eye& eye : {bench::eye_8x8(), bench::eye_80x80()}) {
    auto timed = measure(eye);
    if (!timed) return tl::unexpected(std::move(timed.error()));
    measured.eyes.emplace_back(eye, std::move(*timed));
  }
  return measured;
}

std::string whole_text(const Measured& measured) {
  std::string text = fmt::format("one core reads memory at {:.2f} GB/s\n\n", measured.bandwidth);
  for (const auto& [eye, timed] : measured.eyes) text += table_text(eye, timed);
  return text;
}

std::string whole_json(const Measured& measured) {
  firmware::Json json;
  json["read_bandwidth_gigabytes_per_second"] = measured.bandwidth;
  for (const auto& [eye, timed] : measured.eyes) json["eyes"].push_back(json_of(eye, timed));
  return firmware::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_operators", measure_all, whole_text, whole_json);
}
