// What a call says when it refuses its input.
#pragma once
#include <exception>
#include <string>

namespace vismat::test {

/// The text of the Error that work() throws, or "" if it throws nothing; anything else that it throws goes on.
template <typename Error = std::exception, typename Work>
std::string refusal(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace vismat::test
