// All that `compueye reconstruct` is given: a file of A, a file of y, and what to make of them.

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "firmware/app/commands/reconstruct_files.hpp"
#include "firmware/files/response_file.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/fuzz/invariant.hpp"

using namespace compueye;
using namespace compueye::firmware;
using fuzz::Input;
using fuzz::invariant;

namespace {

/// In memory where the machine has a folder for that.
const std::filesystem::path& folder() {
  static const std::filesystem::path made = [] {
    const std::filesystem::path memory = "/dev/shm";
    const auto base = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    const auto path = base / ("compueye-fuzz-" + std::to_string(getpid()));
    std::filesystem::create_directories(path);
    return path;
  }();
  return made;
}

std::string written(const char* name, std::span<const std::byte> bytes) {
  const std::string file = (folder() / name).string();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file;
}

template <class T>
void check_refusal(const hal::Result<T>& refused) {
  invariant(!refused.error().place.empty() && !refused.error().sentence.empty(),
            "a refusal names a place and a reason");
}

struct Choice {
  recon::Objective objective;
  recon::Plan plan;
  bool sparse = false;
  int image_rows = 1;
};

template <class Kind>
Kind chosen(std::span<const recon::Named<Kind>> table, Input& input) {
  return table[input.byte() % table.size()].kind;
}

/// Any number that can be, most of them ordinary.
double number(Input& input) {
  const int exponent = static_cast<std::int8_t>(input.byte());
  return std::ldexp(1.0 + input.byte() / 256.0, exponent > 100 ? 8 * exponent : exponent);
}

Choice choice_of(Input& input) {
  Choice choice;
  choice.sparse = input.byte() % 2 == 1;
  choice.image_rows = 1 + input.byte() % 16;
  choice.plan.solver = chosen(recon::solver_names(), input);
  choice.objective.basis = chosen(recon::basis_names(), input);
  choice.objective.constraint = chosen(recon::constraint_names(), input);
  choice.plan.precision = chosen(recon::precision_names(), input);
  choice.plan.iterations = 1 + input.byte() % 32;
  choice.plan.rank = input.byte() % 4;
  const std::uint8_t form = input.byte();
  if (form % 4 == 3) choice.plan.op = recon::operator_names()[form / 4 % recon::operator_names().size()].kind;
  choice.objective.lambda = number(input);
  if (input.byte() % 8 == 7) choice.objective.epsilon = number(input);
  if (input.byte() % 8 == 7) choice.plan.rho = number(input);
  choice.plan.measure_gap = true;
  return choice;
}

void check_frame(const recon::Reconstructor& solver, const recon::FrameInfo& info, const std::vector<float>& x) {
  const recon::Objective& o = solver.objective();
  const bool invalid = info.health == recon::Health::invalid;
  for (const float value : x) {
    invariant(std::isfinite(value), "every pixel is finite");
    invariant(!invalid || value == 0.0F, "an invalid frame is black");
    if (invalid || o.constraint == recon::ConstraintKind::none) continue;
    const bool box = o.constraint == recon::ConstraintKind::box;
    invariant(value >= static_cast<float>(box ? o.lo : 0.0), "a pixel keeps its lower bound");
    invariant(!box || value <= static_cast<float>(o.hi), "a pixel keeps its upper bound");
  }
  invariant(invalid || (std::isfinite(info.objective) && std::isfinite(info.residual)),
            "a sound frame's figures are finite");
}

void solve(const FrameInputs& frames, const recon::Reconstructor& solver) {
  constexpr std::int64_t most_frames = 3;
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  std::vector<float> x(static_cast<std::size_t>(solver.pixels()));
  for (std::int64_t f = 0; f < std::min(frames.frames, most_frames); ++f) {
    const recon::FrameInfo info = solver.solve(frames.samples_of(f), frames.weights_of(f), workspace.span(), x);
    check_frame(solver, info, x);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t most_entries = 1 << 14;  // what is solved within a fuzzer's patience
  Input input(data, size);
  Choice choice = choice_of(input);
  const std::size_t length = input.word();
  auto response = read_response(written(choice.sparse ? "a.mtx" : "a.npy", input.take(length)));
  if (!response) return check_refusal(response), 0;
  if (std::int64_t{response->rows()} * response->cols() > most_entries) return 0;
  if (response->cols() % choice.image_rows != 0) choice.image_rows = 1;
  auto sized = response->with_image(choice.image_rows, response->cols() / choice.image_rows);
  const auto frames = read_frame_inputs(*sized, written("y.npy", input.take(input.size())), "");
  if (!frames) return check_refusal(frames), 0;
  choice.plan.max_reweighted = frames->max_reweighted;
  const auto solver =
      recon::Reconstructor::create(scaled_response(*std::move(sized), *frames), choice.objective, choice.plan);
  if (!solver) return check_refusal(solver), 0;
  solve(*frames, *solver);
  return 0;
}
