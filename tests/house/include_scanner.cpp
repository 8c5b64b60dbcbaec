#include "tests/house/include_scanner.hpp"

#include <optional>

namespace compueye::house {
namespace {

std::string_view skip_blanks(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  return begin == std::string_view::npos ? std::string_view{} : text.substr(begin);
}

bool take(std::string_view& text, std::string_view word) {
  text = skip_blanks(text);
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}

std::optional<Include> parse_line(std::string_view text, int line) {
  if (!take(text, "#") || (!take(text, "include_next") && !take(text, "include"))) return std::nullopt;
  text = skip_blanks(text);
  if (text.empty()) return std::nullopt;
  if (text.front() == '"' || text.front() == '<') {
    const auto form = text.front() == '"' ? Include::Form::quoted : Include::Form::angled;
    const auto end = text.find(form == Include::Form::quoted ? '"' : '>', 1);
    return Include{line, std::string(text.substr(1, end == std::string_view::npos ? end : end - 1)), form};
  }
  return Include{line, std::string(text.substr(0, text.find_first_of(" \t\r"))), Include::Form::macro};
}

/// Copies the source with comments blanked and the insides of raw strings dropped; line numbers stay as they are.
/// Ordinary string literals stay: an include line needs its quotes, and they cannot hold a line that starts with '#'.
class CommentRemover {
 public:
  explicit CommentRemover(std::string_view source) : source_(source) {}

  std::string run() {
    while (at_ < source_.size()) {
      if (starts("//")) {
        drop_until("\n", 0);
      } else if (starts("/*")) {
        at_ += 2;
        drop_until("*/", 2);
      } else if (starts("R\"") && (at_ == 0 || !is_name(source_[at_ - 1]))) {
        drop_raw_string();
      } else if (source_[at_] == '"' || (source_[at_] == '\'' && (at_ == 0 || !is_name(source_[at_ - 1])))) {
        copy_literal(source_[at_]);
      } else {
        out_ += source_[at_++];
      }
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool starts(std::string_view word) const { return source_.substr(at_).starts_with(word); }
  [[nodiscard]] static bool is_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  }

  void drop_until(std::string_view end, std::size_t also) {
    const auto found = source_.find(end, at_);
    const auto stop = found == std::string_view::npos ? source_.size() : found + also;
    out_ += ' ';
    for (; at_ < stop; ++at_) {
      if (source_[at_] == '\n') out_ += '\n';
    }
  }

  void drop_raw_string() {
    const auto open = source_.find('(', at_);
    if (open == std::string_view::npos) {
      out_ += source_[at_++];
      return;
    }
    const std::string end = ")" + std::string(source_.substr(at_ + 2, open - at_ - 2)) + "\"";
    drop_until(end, end.size());
  }

  void copy_literal(char quote) {
    out_ += source_[at_++];
    while (at_ < source_.size() && source_[at_] != quote && source_[at_] != '\n') {
      if (source_[at_] == '\\' && at_ + 1 < source_.size()) out_ += source_[at_++];
      out_ += source_[at_++];
    }
    if (at_ < source_.size() && source_[at_] == quote) out_ += source_[at_++];
  }

  std::string_view source_;
  std::size_t at_ = 0;
  std::string out_;
};

}  // namespace

std::vector<Include> scan_includes(std::string_view source) {
  const std::string code = CommentRemover(source).run();
  std::vector<Include> found;
  int line = 1;
  for (std::string_view rest = code; !rest.empty(); ++line) {
    const auto end = rest.find('\n');
    if (auto include = parse_line(rest.substr(0, end), line)) found.push_back(*std::move(include));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return found;
}

}  // namespace compueye::house
