#pragma once

#include <concepts>
#include <functional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace compueye::recon {

/// How a long task tells how far it is, and is told to give up: true of one that somebody listens to.
class Progress {
 public:
  using Tell = std::function<bool(std::string_view what, double done, double total)>;
  using Expect = std::function<void(std::string_view what, double seconds)>;

  Progress() = default;
  template <class Callable>
  requires(!std::same_as<std::remove_cvref_t<Callable>, Progress> && std::convertible_to<Callable, Tell>)
      Progress(Callable&& tell)
      : tell_(std::forward<Callable>(tell)) {}
  Progress(Tell tell, Expect expect) : tell_(std::move(tell)), expect_(std::move(expect)) {}

  [[nodiscard]] explicit operator bool() const noexcept { return tell_ != nullptr; }

  /// `done` of `total` units of `what`; false: give up (error: interrupted).
  bool operator()(std::string_view what, double done, double total) const { return tell_(what, done, total); }

  /// Before `what`: about so many seconds of it, by estimate.
  void expect(std::string_view what, double seconds) const {
    if (expect_) expect_(what, seconds);
  }

  /// The same without estimates, for what is done over and over.
  [[nodiscard]] Progress unestimated() const { return {tell_, {}}; }

 private:
  Tell tell_;
  Expect expect_;
};

}  // namespace compueye::recon
