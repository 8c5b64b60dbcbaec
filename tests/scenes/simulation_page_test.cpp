// docs/simulation.md has every effect with its model, in the order of light.

#include <doctest/doctest.h>

#include <string>

#include "sim/effects/effect.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;

TEST_CASE("docs/simulation.md has every effect with group, model and kind of error, in the order of light") {
  const std::string page = test::bytes_of(test::source_path("docs/simulation.md"));
  std::size_t last = 0;
  for (const sim::Effect* effect : sim::effects()) {
    const std::string row = "| `" + std::string(effect->name) + "` | " + std::string(name(effect->group)) + " | " +
                            std::string(effect->model) + " | " + std::string(name(effect->error)) + " |";
    const std::size_t at = page.find("\n" + row + "\n");
    CHECK_MESSAGE(at != std::string::npos, "docs/simulation.md must contain\n" << row);
    if (at == std::string::npos) continue;
    CHECK(at > last);
    last = at;
  }
}
