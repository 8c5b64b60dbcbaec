#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "sim/effects/effect_list.hpp"
#include "sim/random/random.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::sim;

TEST_CASE("every effect has its parts, a name of its own and draws of its own, in the order of light") {
  std::set<std::string> names;
  std::map<Draws, std::string> drawn_by{{Draws::picture, "pictures"}, {Draws::read_noise, "read noise"}};
  EffectGroup before = EffectGroup::scene;
  for (const Effect* effect : effects()) {
    CAPTURE(effect->name);
    CHECK_FALSE(effect->model.empty());
    CHECK(static_cast<bool>(effect->calls_for));
    CHECK(static_cast<bool>(effect->bound));
    CHECK(static_cast<bool>(effect->cost));
    CHECK(static_cast<bool>(effect->apply));
    CHECK(names.insert(std::string(effect->name)).second);
    const auto drawn = drawn_by.insert({draws_of(effect->name), std::string(effect->name)});
    CHECK_MESSAGE(drawn.second, "draws as " << drawn.first->second << " does");
    CHECK(before <= effect->group);
    before = effect->group;
    CHECK(effect_named(effect->name).value() == effect);
  }
}

TEST_CASE("an unknown effect is answered with the nearest name and all there are") {
  const auto unknown = effect_named("raed_noise");
  test::check_error(unknown, hal::ErrorCode::not_found, "effects", {"raed_noise"});
  CHECK(unknown.error().sentence.find("mean 'read_noise'?") != std::string::npos);
  for (const Effect* effect : effects()) CHECK(test::names(unknown.error().sentence, effect->name));
}

TEST_CASE("groups and kinds of error have names of their own") {
  std::set<std::string_view> names;
  for (const auto group : {EffectGroup::scene, EffectGroup::optics, EffectGroup::detector, EffectGroup::electronics,
                           EffectGroup::timing}) {
    CHECK(names.insert(name(group)).second);
  }
  for (std::size_t kind = 0; kind < error_kinds; ++kind) CHECK(names.insert(name(static_cast<ErrorKind>(kind))).second);
  CHECK(names.count("") == 0);
}
