// A script is NAME { keywords { keywords of a stage } { of the next } } and so on, with // and /* */ comments. Only
// words, braces and how deep they stand matter here. Some authors forget a closing brace: a path alone on the line before
// an opening one is a shader's name, however deep it seems to stand. A quote that is not closed on its line is part of a word.
#include "visibility/levels/shader_script.h"

#include <algorithm>
#include <utility>

#include "visibility/levels/ascii.h"

namespace vismat {
namespace {

struct Word {
  enum class Kind { text, open, close, end } kind;
  std::string text;  // in lower case
  bool begins_line = false;
};

class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // how some editors mark UTF-8
  }
  Word next() {
    const bool begins_line = skip_space_and_comments();
    if (at_ == text_.size()) return {Word::Kind::end, ""};
    if (is_brace(text_[at_])) return {text_[at_++] == '{' ? Word::Kind::open : Word::Kind::close, ""};
    if (text_[at_] == '"') {
      const std::size_t end = text_.find_first_of("\"\n", at_ + 1);
      if (end != std::string_view::npos && text_[end] == '"') {
        const std::string_view quoted = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        return {Word::Kind::text, ascii_lower(quoted), begins_line};
      }
    }
    std::size_t end = at_;
    while (end < text_.size() && !is_space(text_[end]) && !is_brace(text_[end])) ++end;
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    return {Word::Kind::text, ascii_lower(word), begins_line};
  }

 private:
  static bool is_space(char c) { return c >= 0 && c <= ' '; }
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  // Returns whether a new line began, or the text.
  bool skip_space_and_comments() {
    const std::size_t begin = at_;
    for (;;) {
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      const std::string_view two = text_.substr(at_, 2);
      if (two != "//" && two != "/*") break;
      const std::size_t end = two == "//" ? text_.find('\n', at_) : text_.find("*/", at_ + 2);
      at_ = end == std::string_view::npos ? text_.size() : end + (two == "//" ? 1 : 2);
    }
    return begin == 0 || text_.substr(begin, at_ - begin).find('\n') != std::string_view::npos;
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string shader_key(std::string_view name) {
  std::string key = ascii_lower(name);
  std::replace(key.begin(), key.end(), '\\', '/');
  const std::size_t dot = key.rfind('.'), slash = key.rfind('/');
  if (dot != std::string::npos && (slash == std::string::npos || dot > slash)) key.resize(dot);
  return key;
}

void add_see_through_shaders(std::string_view script, std::set<std::string>& names) {
  Words words(script);
  std::string name;
  Word before{Word::Kind::end, ""};
  int depth = 0, stages = 0;
  for (Word word; (word = words.next()).kind != Word::Kind::end; before = std::move(word)) {
    if (word.kind == Word::Kind::open) {
      if (before.begins_line && before.text.find_first_of("/\\") != std::string::npos) depth = 0;
      if (++depth == 1) name = shader_key(before.text), stages = 0;
      if (depth == 2) ++stages;
    } else if (word.kind == Word::Kind::close) {
      depth = std::max(depth - 1, 0);
    } else if ((depth == 2 && word.text == "alphafunc") ||
               (depth == 2 && stages == 1 && word.text == "blendfunc") ||
               (depth == 1 && before.text == "surfaceparm" && word.text == "trans")) {
      names.insert(name);
    }
  }
}

}  // namespace vismat
