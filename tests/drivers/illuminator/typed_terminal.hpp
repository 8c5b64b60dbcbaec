#pragma once

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>

namespace compueye::test {

/// A terminal that a test types at.
class TypedTerminal {
 public:
  TypedTerminal() {
    REQUIRE(hand_ >= 0);
    REQUIRE(::grantpt(hand_) == 0);
    REQUIRE(::unlockpt(hand_) == 0);
    file_ = ::open(::ptsname(hand_), O_RDWR | O_NOCTTY);
    REQUIRE(file_ >= 0);
  }
  TypedTerminal(const TypedTerminal&) = delete;
  TypedTerminal& operator=(const TypedTerminal&) = delete;
  ~TypedTerminal() {
    leave();
    ::close(file_);
  }

  [[nodiscard]] int file() const noexcept { return file_; }
  void type(const std::string& text) const {
    REQUIRE(::write(hand_, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  }
  /// Hangs up.
  void leave() {
    if (hand_ >= 0) ::close(hand_);
    hand_ = -1;
  }
  [[nodiscard]] bool left() const noexcept { return hand_ < 0; }

 private:
  int hand_ = ::posix_openpt(O_RDWR | O_NOCTTY);
  int file_ = -1;
};

}  // namespace compueye::test
