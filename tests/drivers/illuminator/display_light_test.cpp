#include "drivers/illuminator/display_light.hpp"

#include <SDL.h>
#include <doctest/doctest.h>

#include <iostream>
#include <vector>

#include "drivers/illuminator/centred_picture.hpp"
#include "tests/drivers/illuminator/virtual_screen.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using illuminator::DisplayLight;
using test::VirtualScreen;

namespace {

std::vector<std::uint32_t> grey(const std::vector<std::uint32_t>& levels) {
  std::vector<std::uint32_t> pixels;
  for (const std::uint32_t level : levels) pixels.push_back(level * 0x010101U);
  return pixels;
}

/// The colours of a row of screen pixels, each with how many follow each other.
std::vector<std::pair<std::uint32_t, int>> runs(const std::vector<std::uint32_t>& screen, int y) {
  std::vector<std::pair<std::uint32_t, int>> all;
  for (int x = 0; x < VirtualScreen::width; ++x) {
    const std::uint32_t colour = screen[static_cast<std::size_t>(y * VirtualScreen::width + x)];
    if (all.empty() || all.back().first != colour) all.emplace_back(colour, 0);
    ++all.back().second;
  }
  return all;
}

using Runs = std::vector<std::pair<std::uint32_t, int>>;

}  // namespace

#define SCREEN(screen)                                      \
  const VirtualScreen screen;                               \
  if (!(screen).missing().empty()) {                        \
    std::cout << "SKIPPED: " << (screen).missing() << '\n'; \
    return;                                                 \
  }

TEST_CASE("a picture on all of the screen is there when show() returns: whole pixels, in the middle, the rest black") {
  SCREEN(screen);
  hal::VirtualClock clock(7);
  // 200 / 3 and 320 / 3: squares of 66, 122 and 56 are left over, and one above and below.
  const auto light = DisplayLight::create({3, 3, 0, false}, clock).value();
  CHECK(light->describe().levels == 256);
  const std::vector<float> checker{1.0F, 0.0F, 1.0F, 0.0F, 0.5F, 0.0F, 1.0F, 0.25F, 1.0F};
  const auto shown = light->show(checker);
  REQUIRE_MESSAGE(shown.has_value(), shown.error().text());
  CHECK(*shown == 7);
  CHECK(light->place().scale == 66);
  const auto pixels = screen.pixels();
  const auto colours = grey({0, 128, 64, 255});
  const std::uint32_t black = colours[0], half = colours[1], quarter = colours[2], white = colours[3];
  const Runs outside{{black, 320}};
  const Runs top{{black, 61}, {white, 66}, {black, 66}, {white, 66}, {black, 61}};
  const Runs middle{{black, 127}, {half, 66}, {black, 127}};
  const Runs bottom{{black, 61}, {white, 66}, {quarter, 66}, {white, 66}, {black, 61}};
  for (const int y : {0, 199}) CHECK(runs(pixels, y) == outside);
  for (const int y : {1, 66}) CHECK(runs(pixels, y) == top);
  for (const int y : {67, 132}) CHECK(runs(pixels, y) == middle);
  for (const int y : {133, 198}) CHECK(runs(pixels, y) == bottom);
  REQUIRE(light->off().has_value());
  for (const int y : {1, 100, 198}) CHECK(runs(screen.pixels(), y) == outside);
}

TEST_CASE("every one of the 256 levels is shown as it is") {
  SCREEN(screen);
  hal::VirtualClock clock;
  const auto light = DisplayLight::create({1, 256, 0, false}, clock).value();
  std::vector<float> ramp;
  for (int k = 0; k < 256; ++k) ramp.push_back(static_cast<float>(k) / 255.0F);
  REQUIRE(light->show(ramp).has_value());
  const auto pixels = screen.pixels();
  for (std::uint32_t k = 0; k < 256; ++k) {
    const auto at = static_cast<std::size_t>(light->place().top * VirtualScreen::width + light->place().left) + k;
    CHECK(pixels[at] == k * 0x010101U);
  }
}

TEST_CASE("a window leaves the rest of the screen alone, and is missed when it is closed, hidden or moved") {
  SCREEN(screen);
  hal::VirtualClock clock;
  const std::vector<float> white(4, 1.0F);
  const auto sent = [](std::uint8_t event) {
    SDL_Event sent_event{};
    sent_event.type = SDL_WINDOWEVENT;
    sent_event.window.event = event;
    // Windows are numbered from 1 on, and each test has opened one.
    for (std::uint32_t id = 1; id < 100; ++id) {
      if (SDL_GetWindowFromID(id) != nullptr) sent_event.window.windowID = id;
    }
    REQUIRE(SDL_PushEvent(&sent_event) == 1);
  };
  for (const auto event : {SDL_WINDOWEVENT_CLOSE, SDL_WINDOWEVENT_HIDDEN}) {
    const auto light = DisplayLight::create({2, 2, 0, true}, clock).value();
    REQUIRE(light->show(white).has_value());
    CHECK(light->place().scale == 75);
    CHECK(light->place().left == 0);
    CHECK(light->attend().has_value());
    const auto pixels = screen.pixels();
    CHECK(std::count(pixels.begin(), pixels.end(), 0xFFFFFFU) == 150 * 150);
    sent(static_cast<std::uint8_t>(event));
    test::check_error(light->attend(), hal::ErrorCode::disconnected, "display", {});
  }
  const auto light = DisplayLight::create({2, 2, 0, true}, clock).value();
  REQUIRE(light->show(white).has_value());
  REQUIRE(light->show(white).has_value());
  SDL_Window* window = nullptr;
  for (std::uint32_t id = 1; id < 100 && window == nullptr; ++id) window = SDL_GetWindowFromID(id);
  REQUIRE(window != nullptr);
  SDL_SetWindowPosition(window, 3, 4);
  test::check_error(light->attend(), hal::ErrorCode::disconnected, "display", {"moved"});
}

TEST_CASE("a monitor that is not there, a picture that is too large and one of another size are refused") {
  SCREEN(screen);
  hal::VirtualClock clock;
  test::check_error(DisplayLight::create({2, 2, 3, false}, clock), hal::ErrorCode::not_found, "display", {"3", "0"});
  test::check_error(DisplayLight::create({2, 300, 0, true}, clock), hal::ErrorCode::out_of_range, "display",
                    {"240x150", "300x2"});
  const auto light = DisplayLight::create({2, 2, 0, false}, clock).value();
  test::check_error(light->show(std::vector<float>(5, 1.0F)), hal::ErrorCode::mismatch, "display", {"5", "4"});
}

TEST_CASE("no display at all is an error that says where to call it from") {
  SCREEN(screen);
  ::setenv("DISPLAY", ":nowhere", 1);
  hal::VirtualClock clock;
  test::check_error(DisplayLight::create({2, 2, 0, false}, clock), hal::ErrorCode::unsupported, "display",
                    {"desktop", "console"});
}
