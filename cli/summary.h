// Lines of a name and a value, which verbs print about a file.
#pragma once
#include <array>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

#include "matrix/deltas.h"
#include "matrix/loss.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {

/// The text with each control character replaced by '?', since those of a hostile file would rearrange the terminal.
std::string printable(std::string_view text);
/// Prints one line on stdout, with control characters replaced; the values of several lines stand below one another.
void line(const char* what, const std::string& value);
/// The number with its digits in groups: "729 330".
std::string grouped(std::uint64_t number);

/// What rows or columns are, in the plural: "view cells", "objects at a level of detail".
std::string plural_of(std::string_view what);

template <typename... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::uint64_t see_through_objects(const Scene& scene);  // how many

/// What the boundaries are, in words: "6 331 between 2 415 view cells, 1 from outside".
std::string summary_of(std::span<const Boundary> boundaries);

/// Prints the scene's bounds and origin in the coordinates of the file that it was made from, its size, and which way up it
/// probably is.
void print_extent(const SceneFile& file);

/// Prints what of its file a scene does not hold, and what a user should know: a line for each.
void print_notes(const AnyScene& scene);

/// Prints how many entries were added, and to which view cell the most.
void print_loss(const Loss& loss);

}  // namespace vismat::cli
