// A folder in which tests run the program vismat, as a user does in a shell.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "matrix/dataset.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {

struct Finished {
  int code = 0;  // -1 after a signal
  std::string out, error;
  unsigned changes = 0;  // to files, if they were counted
};

class Program : public testing::Test {
 protected:
  /// Runs `vismat WORDS`, with blanks between the words, in the folder and as the leader of a process group, as a shell does;
  /// Ctrl-C as soon as its first thread has made `changes` changes to files, if that is not zero and it makes so many. Changes
  /// are counted where it is not zero, up to Ctrl-C.
  Finished vismat(const std::string& words, unsigned changes = 0) const;
  /// The same; a failed expectation unless it exits with 0.
  Finished vismat_succeeds(const std::string& words) const;
  /// It exits with 1, says why in one line, and leaves no file.
  void expect_refusal(const std::string& words, const std::string& why) const;

  void write(const std::string& file, const std::string& text) const;
  void write(const std::string& file, const Dataset& dataset) const;
  std::string contents(const std::string& file) const;
  Dataset dataset(const std::string& file) const;

  TemporaryFolder folder;
};

bool contains(const std::string& text, const std::string& part);
std::size_t count_lines(const std::string& text);

/// A matrix of `count` view cells on a line, in another order, that see the objects near them; rows and columns have boxes.
Dataset ring_of_clusters(std::uint32_t count);
/// The columns of a row, a line each, as `vismat row` prints them.
std::string printed_row(const VisibilityMatrix& matrix, std::uint32_t row);

}  // namespace vismat
