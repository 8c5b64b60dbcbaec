#include "drivers/illuminator/manual_light.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include "tests/drivers/illuminator/typed_terminal.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;

namespace {

/// A person at a terminal, who types what `answers` say when told something.
struct Person {
  test::TypedTerminal terminal;
  std::vector<hal::Image> written;
  std::vector<std::string> told;
  std::string answer = "\n";
  int waited = 0, patience = 1000;

  illuminator::ManualSettings settings() {
    illuminator::ManualSettings settings;
    settings.rows = 2;
    settings.cols = 2;
    settings.file = "next.png";
    settings.input = terminal.file();
    settings.write = [this](const hal::Image& picture) -> hal::Result<void> {
      written.push_back(picture);
      return {};
    };
    settings.tell = [this](std::string_view line) { told.emplace_back(line); };
    settings.meanwhile = [this]() -> hal::Result<void> {
      if (++waited == 3 && !terminal.left()) terminal.type(answer);
      if (waited > patience) return hal::fail(hal::ErrorCode::interrupted, "test", "nobody came");
      return {};
    };
    return settings;
  }
};

}  // namespace

TEST_CASE("light by hand writes a picture, says where it is, and waits for Enter") {
  Person person;
  hal::VirtualClock clock(5);
  const auto light = illuminator::ManualLight::create(person.settings(), clock).value();
  const std::vector<float> picture{0.0F, 0.25F, 0.5F, 1.0F};
  CHECK(light->show(picture).value() == 5);
  CHECK(person.waited >= 3);
  REQUIRE(person.written.size() == 1);
  CHECK(person.written[0].pixels == picture);
  CHECK(person.written[0].cols == 2);
  REQUIRE(person.told.size() == 1);
  CHECK(person.told[0].find("next.png") != std::string::npos);

  // The same picture is there already.
  CHECK(light->show(picture).has_value());
  CHECK(person.told.size() == 1);

  person.waited = 0;
  CHECK(light->off().has_value());
  CHECK(person.told.size() == 2);
  CHECK(person.written.size() == 1);
  person.waited = 0;
  CHECK(light->show(picture).has_value());
  CHECK(person.told.size() == 3);
}

TEST_CASE("a key pressed before the picture was asked for does not count, nor one without Enter") {
  Person person;
  hal::VirtualClock clock;
  const auto light = illuminator::ManualLight::create(person.settings(), clock).value();
  person.terminal.type("\n\n");
  person.answer = "x";
  const std::vector<float> white(4, 1.0F);
  test::check_error(light->show(white), hal::ErrorCode::interrupted, "test", {});
  // What was not there is asked for again.
  person.answer = "\n";
  person.waited = 0;
  CHECK(light->show(white).has_value());
  CHECK(person.told.size() == 2);
}

TEST_CASE("what is no terminal, and one whose input ends, are errors that say so") {
  Person person;
  hal::VirtualClock clock;
  illuminator::ManualSettings settings = person.settings();
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  settings.input = ends[0];
  test::check_error(illuminator::ManualLight::create(settings, clock), hal::ErrorCode::usage, "standard input",
                    {"terminal"});
  ::close(ends[0]);
  ::close(ends[1]);

  const std::vector<float> white(4, 1.0F);
  {
    const auto light = illuminator::ManualLight::create(person.settings(), clock).value();
    person.answer = "\x04";  // Ctrl-D
    test::check_error(light->show(white), hal::ErrorCode::end_of_stream, "terminal", {});
    person.terminal.leave();
    test::check_error(light->show(white), hal::ErrorCode::end_of_stream, "terminal", {});
    test::check_error(light->show(std::vector<float>(3, 1.0F)), hal::ErrorCode::mismatch, "picture", {"3", "4"});
  }
}
