// What planning effects saves: first frame with everything that belongs to it, and the frames after it, with every
// effect there is, with those that are planned, and with none; every scene of scenes/ before each board given (by
// default boards/sim-8x8 and boards/sim-80x80). Run in the project's folder.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/text/table.hpp"
#include "hal/try.hpp"
#include "sim/simulation.hpp"

using namespace compueye;

namespace {

constexpr int frames = 20, repeats = 3;

struct Mode {
  double first_ms = 0.0, frame_ms = 0.0;
  [[nodiscard]] double whole_ms() const { return first_ms + frames * frame_ms; }
};

struct Line {
  std::string board, scene;
  bool still = false;
  Mode everything, planned, nothing;
  int effects_on = 0;
};

hal::Result<Mode> timed(const firmware::Board& board, const sim::Scene& scene, sim::PlanMode mode, int& on) {
  std::vector<double> first, later;
  for (int k = 0; k < repeats; ++k) {
    auto settings = firmware::simulated_eye_settings(board, scene, 1);
    std::vector<std::int32_t> codes(static_cast<std::size_t>(board.eye.ommatidia()));
    std::optional<hal::Result<sim::Simulation>> made;
    first.push_back(bench::milliseconds([&] {
      made = sim::Simulation::create(settings.board, scene, 1, {.budget = {mode}});
      if (*made) static_cast<void>((*made)->codes(0, codes));
    }));
    if (!*made) return tl::unexpected(made->error());
    const auto& planned = (*made)->plan().effects;
    on = static_cast<int>(std::count_if(planned.begin(), planned.end(), [](const auto& e) { return e.on(); }));
    later.push_back(bench::milliseconds([&] {
                      for (std::uint64_t f = 1; f <= frames; ++f) static_cast<void>((*made)->codes(f, codes));
                    }) /
                    frames);
  }
  return Mode{bench::median(first), bench::median(later)};
}

hal::Result<Line> line_of(const std::string& board_folder, const std::string& file) {
  const firmware::Board board = TRY(firmware::load_board(board_folder));
  const sim::Scene scene = TRY(firmware::choose_scene(board, {file, 0, std::nullopt}));
  Line line{board.name, scene.name, scene.still(), {}, {}, {}, 0};
  int ignored = 0;
  line.everything = TRY(timed(board, scene, sim::PlanMode::everything, ignored));
  line.planned = TRY(timed(board, scene, sim::PlanMode::automatic, line.effects_on));
  line.nothing = TRY(timed(board, scene, sim::PlanMode::nothing, ignored));
  return line;
}

std::string table_text(const std::vector<Line>& lines) {
  using firmware::Align;
  firmware::Table table({{"board", Align::left},
                         {"scene", Align::left},
                         {"effects on"},
                         {"everything, first ms"},
                         {"frame ms"},
                         {"planned, first ms"},
                         {"frame ms"},
                         {"nothing, first ms"},
                         {"frame ms"},
                         {fmt::format("everything / planned over {} frames", frames)}});
  for (const Line& l : lines) {
    const auto ms = [](double v) { return fmt::format("{:.3g}", v); };
    table.add({l.board, l.scene + (l.still ? "" : " (moves)"), std::to_string(l.effects_on), ms(l.everything.first_ms),
               ms(l.everything.frame_ms), ms(l.planned.first_ms), ms(l.planned.frame_ms), ms(l.nothing.first_ms),
               ms(l.nothing.frame_ms), fmt::format("{:.1f}", l.everything.whole_ms() / l.planned.whole_ms())});
  }
  return table.text() + "\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> boards(argv + 1, argv + argc);
  if (boards.empty()) boards = {"boards/sim-8x8", "boards/sim-80x80"};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator("scenes")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  std::vector<Line> lines;
  for (const std::string& board : boards) {
    for (const std::string& file : files) {
      const auto line = line_of(board, file);
      if (!line) {
        fmt::print(stderr, "{}\n", line.error().text());
        return 1;
      }
      lines.push_back(*line);
    }
  }
  fmt::print("{}", table_text(lines));
  return 0;
}
