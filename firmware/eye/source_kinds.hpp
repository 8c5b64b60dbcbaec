#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "drivers/protocol/bus.hpp"

namespace compueye::firmware {

/// What a board's [source] kind can be: simulated, an eye on a bus, or converters on the machine's own SPI, which
/// [wiring] describes. source_list.cpp makes sources of them;
/// recordings are replayed instead of a board's eye, whatever its kind.
struct SourceKind {
  std::string_view name;
  const protocol::Bus* bus = nullptr;  ///< null: none of ours
  bool simulated = false;
};

/// "sim", a kind a bus, and "spi".
inline constexpr auto source_kinds = [] {
  std::array<SourceKind, 2 + protocol::buses.size()> kinds{{{"sim", nullptr, true}}};
  for (std::size_t k = 0; k < protocol::buses.size(); ++k)
    kinds[k + 1] = {protocol::buses[k]->name, protocol::buses[k]};
  kinds.back() = {"spi"};
  return kinds;
}();

inline constexpr auto source_kind_names = [] {
  std::array<std::string_view, source_kinds.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = source_kinds[k].name;
  return names;
}();

/// The bus of a kind; null for an eye that is on none.
[[nodiscard]] constexpr const protocol::Bus* bus_of_kind(std::string_view name) noexcept {
  for (const SourceKind& kind : source_kinds) {
    if (kind.name == name) return kind.bus;
  }
  return nullptr;
}

}  // namespace compueye::firmware
