#include "firmware/text/figures.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

using namespace compueye::firmware;

namespace {

Figures some() {
  return {{"file", "a\nb.rec"},
          {"frames", 1},
          {"lines", std::uint64_t{1234567}},
          {"none", std::optional<int>()},
          {"rate_hz", 30.0},
          {"share", 0.123456},
          {"unknown", std::nan("")},
          {"bytes", 1536},
          {"wall_s", 185.0},
          {"span_ns", 185'000'000'000},
          {"serial", ""},
          {"live", true},
          {"dropped", Figures{{"superseded", 2}, {"corrupt", 0}, {"stopped", 1}}},
          {"nothing", Figures{{"superseded", 0}, {"why", ""}}},
          {"scenes", Value::List{"dots", "bars"}},
          {"last", Figures{{"quality", Figures{{"nmse", 0.5}}}}}};
}

}  // namespace

TEST_CASE("a sentence takes the figures by their keys") {
  const Figures f = some();
  CHECK(f.sentence("{file}: {frames} of {lines}, {rate_hz} Hz, {live}, {scenes}") ==
        "a\\nb.rec: 1 of 1234567, 30 Hz, true, dots, bars");
  CHECK(f.sentence("{last.quality.nmse} {dropped.superseded} {dropped}") == "0.5 2 2 superseded, 1 stopped");
  CHECK(f.sentence("").empty());
  CHECK(f.sentence("[[{frames}, {{frames}}]]") == "[1, {frames}]");
  CHECK(Figures{{"first", 1}, {"last", 2.5}}.sentence("{} {:3}") == "2.5 2.50");
}

TEST_CASE("a figure has the form that its sentence asks for") {
  const Figures f = some();
  CHECK(f.sentence("{share:3} {share:.2} {lines:,} {bytes:bytes}") == "0.123 0.12 1,234,567 1.50 KiB");
  CHECK(f.sentence("{wall_s:duration} {span_ns:ns} {dropped:sum}") == "3 min 05 s 3 min 05 s 3");
  CHECK(f.sentence("{share:3%} {scenes:count} {frames:count} {scenes.1} {scenes.2}") == "12.3 % 2 0 bars n/a");
  CHECK(f.sentence("{frames:# frame} {dropped.superseded:# time} {dropped.corrupt:# frame}") ==
        "1 frame 2 times 0 frames");
  CHECK(f.sentence("{live:'on'|off} {dropped.corrupt:'on'|off} {serial:|any} {frames:|any} {share:.1|none}") ==
        "on off any 1 0.1");
}

TEST_CASE("what is null is told so, and a part that says nothing is left out") {
  const Figures f = some();
  CHECK(f.sentence("{none} {none:3} {none.inner} {scenes.9}") == "n/a n/a n/a n/a");
  CHECK(f.sentence("{none} {none:bytes} {none:3|nothing}", "-") == "- - nothing");
  CHECK(f.sentence("a[ {dropped.corrupt} corrupt][, {dropped.stopped} stopped][ ({nothing})][{serial}{none}]z") ==
        "a, 1 stoppedz");
  CHECK(f.sentence("[{dropped.corrupt} of {frames}]") == "0 of 1");
}

TEST_CASE("a key that nothing has stays as it was written, but where a row may lack it") {
  const Figures f = some();
  const std::string_view slips = "{nowhere} {file.inner} {last.quality.none} {lines.one:3}";
  CHECK(f.sentence(slips) == slips);
  CHECK(f.sentence(slips, "-", true) == "- - - -");
}

TEST_CASE("text is what was told, in order, and then the lines") {
  Figures f = some();
  f.tell("{frames:# frame}").say(" {frames}[\n").tell("{bytes}\n");
  CHECK(f.text() == "1 frame {frames}[\n1536\n");
  f.line("frames", "1");
  CHECK(f.text() == "1 frame {frames}[\n1536\nfigure  value\n------  -----\nframes  1\n");
  CHECK(Figures{}.text().empty());
}

TEST_CASE("a table has a line for each of the figures") {
  const Value::List rows{Figures{{"name", "dots"}, {"nmse", 0.25}}, Figures{{"name", "bars"}, {"nmse", Value()}},
                         "no figures"};
  CHECK(table_of(rows, {{"scene", "{name}", Align::left}, {"NMSE", "{nmse:3}[ *{name}]"}}) ==
        "scene         NMSE\n"
        "-----  -----------\n"
        "dots   0.250 *dots\n"
        "bars       - *bars\n"
        "\n");
  CHECK(table_of({}, {{"scene", "{name}"}}).empty());
}
