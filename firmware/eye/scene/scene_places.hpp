#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/settings/toml_document.hpp"
#include "hal/error.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// Where a scene file says what.
class ScenePlaces {
 public:
  ScenePlaces(std::string file, TomlDocument document);

  [[nodiscard]] const TomlDocument& document() const noexcept { return document_; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] int surfaces() const noexcept;
  [[nodiscard]] bool has(std::string_view section) const noexcept;
  [[nodiscard]] bool states(std::string_view section, std::string_view key, int number = 0) const noexcept;
  /// "scene.toml:7": the line of the key, else of its section, else the bare file.
  [[nodiscard]] std::string of(std::string_view section, std::string_view key, int number = 0) const;

  /// What sim's checks say of a surface or of the scene, with the line of the first stated key that the sentence names
  /// or that moves the surface.
  [[nodiscard]] hal::Error placed(hal::Error error, const sim::Scene& scene) const;

 private:
  [[nodiscard]] const TomlEntry* entry(std::string_view section, std::string_view key, int number) const noexcept;
  std::string file_;
  TomlDocument document_;
};

}  // namespace compueye::firmware
