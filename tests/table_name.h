// Names of test cases over a table: the entry's own, where GoogleTest allows no hyphens.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace vismat::test {

inline constexpr auto table_name = [](const auto& entry) {
  std::string name(entry.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};

}  // namespace vismat::test
