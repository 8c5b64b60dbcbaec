#include "firmware/eye/settings/reconstruction_keys.hpp"

#include "firmware/eye/settings/key_values.hpp"
#include "firmware/eye/settings/reconstruction_names.hpp"

namespace compueye::firmware {
namespace {

using enum ValueType;
using V = TomlValue;

std::vector<std::string_view> operator_words() {
  std::vector<std::string_view> list = words(operator_names());
  list.insert(list.begin(), "auto");
  return list;
}

std::vector<KeySpec> problem_keys() {
  return {
      {.section = "reconstruction",
       .name = "solver",
       .type = choice,
       .choices = words(solver_names()),
       .fallback = V{std::string("admm")},
       .meaning = "docs/solvers.md says which to use when",
       .store = [](Board& b, const V& v) { b.reconstruction.solver = kind_of(solver_names(), v); }},
      {.section = "reconstruction",
       .name = "basis",
       .type = choice,
       .choices = words(basis_names()),
       .fallback = V{std::string("dct")},
       .meaning = "in which the picture is taken to be sparse",
       .store = [](Board& b, const V& v) { b.reconstruction.basis = kind_of(basis_names(), v); }},
      {.section = "reconstruction",
       .name = "constraint",
       .type = choice,
       .choices = words(constraint_names()),
       .fallback = V{std::string("nonnegative")},
       .meaning = "what every pixel must obey",
       .store = [](Board& b, const V& v) { b.reconstruction.constraint = kind_of(constraint_names(), v); }},
      {.section = "reconstruction",
       .name = "box",
       .type = real_pair,
       .range = {-1e6, 1e6},
       .fallback = V{std::vector<std::int64_t>{0, 1}},
       .meaning = "least and greatest intensity, white being 1; only with the box constraint",
       .store =
           [](Board& b, const V& v) {
             b.reconstruction.box_lo = pair_of(v)[0];
             b.reconstruction.box_hi = pair_of(v)[1];
           }},
  };
}

std::vector<KeySpec> solver_keys() {
  return {
      {.section = "reconstruction",
       .name = "iterations",
       .type = whole,
       .range = {1, 1000000},
       .fallback = V{std::int64_t{100}},
       .meaning = "of the solver in every frame, no more and no fewer",
       .store = [](Board& b, const V& v) { b.reconstruction.iterations = whole_of(v); }},
      {.section = "reconstruction",
       .name = "lambda",
       .type = real,
       .range = {0, 1e12},
       .meaning = "weight of the penalty; left out, it follows from the noise",
       .store = [](Board& b, const V& v) { b.reconstruction.lambda = real_of(v); }},
      {.section = "reconstruction",
       .name = "sigma",
       .type = real,
       .range = {0, 1e9},
       .meaning = "noise of one sample in fully seen white pixels; left out, it is LSB sqrt(read_noise_lsb^2 + 1/12)",
       .store = [](Board& b, const V& v) { b.reconstruction.sigma = real_of(v); }},
      {.section = "reconstruction",
       .name = "rho",
       .type = real,
       .range = {1e-12, 1e12},
       .meaning = "ADMM penalty; left out, it follows from the response",
       .store = [](Board& b, const V& v) { b.reconstruction.rho = real_of(v); }},
      {.section = "reconstruction",
       .name = "relaxation",
       .type = real,
       .range = {0, 2, true, true},
       .fallback = V{1.7},
       .meaning = "over-relaxation of admm, cp and pdhg",
       .store = [](Board& b, const V& v) { b.reconstruction.relaxation = real_of(v); }},
      {.section = "reconstruction",
       .name = "operator",
       .type = choice,
       .choices = operator_words(),
       .fallback = V{std::string("auto")},
       .meaning = "how A is applied; auto is the quickest that keeps every digit, bf16 and int8 round the response",
       .store =
           [](Board& b, const V& v) {
             if (text_of(v) != "auto") b.reconstruction.op = kind_of(operator_names(), v);
           }},
      {.section = "reconstruction",
       .name = "start",
       .type = choice,
       .choices = {"cold", "warm"},
       .fallback = V{std::string("cold")},
       .meaning = "warm, with pdhg: a frame goes on from the last one, unless it has changed too much",
       .store = [](Board& b, const V& v) { b.reconstruction.warm_start = text_of(v) == "warm"; }},
      {.section = "reconstruction",
       .name = "threads",
       .type = whole,
       .range = {1, 64},
       .fallback = V{std::int64_t{1}},
       .meaning = "that share a frame's work; pictures are the same bit for bit",
       .store = [](Board& b, const V& v) { b.reconstruction.threads = whole_of(v); }},
  };
}

}  // namespace

std::vector<KeySpec> reconstruction_keys() {
  std::vector<KeySpec> keys = problem_keys();
  const std::vector<KeySpec> more = solver_keys();
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace compueye::firmware
