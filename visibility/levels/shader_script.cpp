// A script is NAME { keywords { keywords of a stage } { of the next } } and so on, with // and /* */ comments. Only words, braces and
// how deep they stand matter here.
#include "visibility/levels/shader_script.h"

#include <algorithm>

namespace vismat {
namespace {

class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  /// The next word in lower case, or brace; empty at the end.
  std::string next() {
    skip_space_and_comments();
    std::size_t end = at_;
    while (end < text_.size() && !is_space(text_[end]) && !is_brace(text_[end])) ++end;
    if (end == at_ && end < text_.size()) ++end;  // a brace
    std::string word(text_.substr(at_, end - at_));
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    at_ = end;
    return word;
  }

 private:
  static bool is_space(char c) { return c >= 0 && c <= ' '; }
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  void skip_space_and_comments() {
    for (;;) {
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      const std::string_view two = text_.substr(at_, 2);
      if (two != "//" && two != "/*") return;
      const std::size_t end = two == "//" ? text_.find('\n', at_) : text_.find("*/", at_ + 2);
      at_ = end == std::string_view::npos ? text_.size() : end + (two == "//" ? 1 : 2);
    }
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

void add_see_through_shaders(std::string_view script, std::set<std::string>& names) {
  Words words(script);
  std::string name, before;
  int depth = 0, stages = 0;
  for (std::string word; !(word = words.next()).empty(); before = std::move(word)) {
    if (word == "{") {
      if (++depth == 1) name = before, stages = 0;
      if (depth == 2) ++stages;
    } else if (word == "}") {
      depth = std::max(depth - 1, 0);
    } else if ((depth == 2 && word == "alphafunc") || (depth == 2 && stages == 1 && word == "blendfunc") ||
               (depth == 1 && before == "surfaceparm" && word == "trans")) {
      names.insert(name);
    }
  }
}

}  // namespace vismat
