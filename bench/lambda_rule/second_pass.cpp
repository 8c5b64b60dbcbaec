#include "bench/lambda_rule/second_pass.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>

namespace compueye::bench {
namespace {

constexpr float lit_above = 0.1F;

/// A diag(factors), entries that become zero left out.
recon::Response scaled_columns(const recon::Response& response, const std::vector<float>& factors) {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      const double scaled = v * factors[static_cast<std::size_t>(n)];
      if (scaled == 0.0) return;
      columns.push_back(n);
      values.push_back(scaled);
    });
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return recon::Response::from_csr(response.rows(), response.cols(), start, columns, values)
      .value()
      .with_image(response.image_rows(), response.image_cols())
      .value();
}

}  // namespace

std::vector<float> solved(const Case& c, const recon::Response& response, const recon::Objective& objective,
                          const std::vector<float>& y, std::optional<recon::Factor>& factor, double l1_reweighting) {
  recon::Plan plan;
  plan.l1_reweighting = l1_reweighting;
  plan.iterations = c.iterations;
  const auto solver = recon::Reconstructor::create(response, objective, plan, factor).value();
  if (!factor) factor = solver.factor();
  const std::size_t bytes = solver.required_bytes();
  auto* memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}));
  std::vector<float> x(static_cast<std::size_t>(response.cols()));
  static_cast<void>(solver.solve(y, {}, {memory, bytes}, x));
  ::operator delete (memory, std::align_val_t{64});
  return x;
}

std::vector<float> debiased(const Case& c, const recon::Response& response, const std::vector<float>& y,
                            const std::vector<float>& x) {
  std::vector<float> support(x.size());
  for (std::size_t n = 0; n < x.size(); ++n) support[n] = x[n] > lit_above ? 1.0F : 0.0F;
  const recon::Response seen = scaled_columns(response, support);
  if (seen.stored_entries() == 0) return x;
  recon::Objective objective;
  objective.constraint = c.constraint;
  objective.lambda = 1e-6;
  std::optional<recon::Factor> factor;
  return solved(c, seen, objective, y, factor);
}

std::vector<float> reweighted(const Case& c, const recon::Response& response, const std::vector<float>& y,
                              const recon::Objective& objective, std::optional<recon::Factor>& factor) {
  return solved(c, response, objective, y, factor, lit_above);
}

}  // namespace compueye::bench
