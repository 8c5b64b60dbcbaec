// Hard cases stay numerically stable: every row, in every solver, basis, constraint and precision that it is for.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string>

#include "recon/option_names.hpp"
#include "tests/hard/hard_promises.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

const Waiting* waits(const HardRow& row, const HardSetting& setting, const Broken& broken) {
  const auto fits = [](std::string_view pattern, std::string_view word) { return pattern == "*" || pattern == word; };
  const std::string_view precision = recon::name(setting.precision);
  const auto found = std::find_if(waiting().begin(), waiting().end(), [&](const Waiting& w) {
    return fits(w.row, row.hard.name) && fits(w.solver, recon::name(setting.solver)) && fits(w.precision, precision) &&
           fits(w.promise, broken.promise);
  });
  return found == waiting().end() ? nullptr : &*found;
}

/// Every promise of every run; what waits for something is counted and printed.
class Checks {
 public:
  void add(const HardRow& row) {
    const firmware::HardProblem problem = firmware::pose(row.hard, row.eye(), 1);
    HardPromises promises(row, problem);
    int solved = 0;
    for (const HardSetting& setting : settings_of(row)) {
      const HardRun result = run(row, setting, problem);
      ++runs_;
      refused_ += result.refused.has_value();
      solved += !result.refused;
      for (const Broken& broken : promises.broken_by(setting, result)) tell(row, setting, broken);
    }
    if (solved == 0 && row.must != Must::be_refused) tell(row, {recon::default_solver()}, {"solved", "by nobody"});
  }

  [[nodiscard]] int runs() const noexcept { return runs_; }

  ~Checks() {
    std::printf("%d runs, %d refused by name\n", runs_, refused_);
    for (const auto& [what, times] : waited_) std::printf("waits for %s: %d broken promises\n", what.c_str(), times);
  }

 private:
  void tell(const HardRow& row, const HardSetting& setting, const Broken& broken) {
    if (const Waiting* item = waits(row, setting, broken)) {
      ++waited_[std::string(item->item) + ": " + std::string(row.hard.name)];
    } else {
      FAIL_CHECK(row.hard.name << ", " << setting.name() << ": " << broken.promise << ": " << broken.found);
    }
  }

  int runs_ = 0, refused_ = 0;
  std::map<std::string, int> waited_;
};

void check_rows(const std::vector<HardRow>& rows) {
  Checks checks;
  for (const HardRow& row : rows) {
#if defined(COMPUEYE_SANITIZED)
    if (!row.judged) continue;  // a large eye
#endif
    checks.add(row);
  }
  CHECK(checks.runs() > static_cast<int>(rows.size()) / 2);
}

}  // namespace

TEST_CASE("conditioning: promises hold however near to singular the rows are") {
  check_rows(conditioning_rows());
}

TEST_CASE("degenerate: promises hold where rows, pixels or all of A are missing") {
  check_rows(degenerate_rows());
}

TEST_CASE("samples: promises hold whatever is read") {
  check_rows(sample_rows());
}

TEST_CASE("parameters: promises hold to the ends of what may be asked") {
  check_rows(parameter_rows());
}

TEST_CASE("every case of compueye stability keeps the promises on a small eye") {
  check_rows(product_rows());
}

TEST_CASE("there are sixty cases and more, each with a name of its own and the reason it is hard") {
  std::set<std::string_view> names;
  std::size_t count = 0;
  for (const auto& rows : {conditioning_rows(), degenerate_rows(), sample_rows(), parameter_rows(), product_rows()}) {
    for (const HardRow& row : rows) {
      CHECK(row.hard.reason.ends_with("."));
      names.insert(row.hard.name);
      ++count;
    }
  }
  CHECK(names.size() == count);
  CHECK(count >= 60);
}
