#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace compueye::recon {

/// The tables that a core::FrameProblem looks at: each stays where it is as long as this lives.
class KeptTables {
 public:
  template <class Element>
  [[nodiscard]] const Element* keep(std::vector<Element> values) {
    bytes_ += values.size() * sizeof(Element);
    return kept(std::move(values)).data();
  }

  /// Of tables that have a `view` of themselves, and say how many bytes() they take: the view.
  template <class Tables>
  [[nodiscard]] auto keep_view(Tables tables) {
    bytes_ += tables.bytes();
    return kept(std::move(tables)).view;
  }

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  template <class Tables>
  const Tables& kept(Tables tables) {
    auto owned = std::make_shared<const Tables>(std::move(tables));
    const Tables& there = *owned;
    tables_.push_back(std::move(owned));
    return there;
  }

  std::vector<std::shared_ptr<const void>> tables_;
  std::size_t bytes_ = 0;
};

}  // namespace compueye::recon
