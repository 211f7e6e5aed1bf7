// What unpacks to much more than it says. matrix_files_test.py has the files that are well.
#include <gtest/gtest.h>
#include <zlib.h>

#include "matrix/base/byte_reader.h"
#include "matrix/files/gzip.h"
#include "matrix/files/npy.h"
#include "matrix/files/npz.h"

namespace vismat {
namespace {

std::vector<std::byte> gzipped(std::size_t zeros) {
  z_stream z = {};
  deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::vector<Bytef> in(zeros, 0), out(zeros + 1000);
  z.next_in = in.data();
  z.avail_in = static_cast<uInt>(in.size());
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  deflateEnd(&z);
  const auto bytes = std::as_bytes(std::span(out).first(z.total_out));
  return {bytes.begin(), bytes.end()};
}

TEST(PackedFiles, MayUnpackToNoMoreThanTold) {
  const auto one = gzipped(100'000);
  EXPECT_EQ(gunzip(one, 100'000).size(), 100'000u);
  EXPECT_THROW(gunzip(one, 99'999), FormatError);
  auto two = one;
  two.insert(two.end(), one.begin(), one.end());
  EXPECT_EQ(gunzip(two, 200'000).size(), 200'000u);
  EXPECT_THROW(gunzip(two, 199'999), FormatError);

  std::vector<std::uint32_t> row(1000);
  for (std::uint32_t c = 0; c < row.size(); ++c) row[c] = c;
  const auto matrix = VisibilityMatrix::from_rows(std::vector(100, row), 1000);
  const auto npz = npz_of(matrix);
  EXPECT_LT(npz.size(), 100'000u);
  EXPECT_EQ(read_npz(npz, 1'000'000), matrix);
  EXPECT_THROW(read_npz(npz, 400'000), FormatError);
  EXPECT_EQ(most_unpacked(10), std::uint64_t{1} << 30);
  EXPECT_EQ(most_unpacked(std::uint64_t{1} << 30), 200 * (std::uint64_t{1} << 30));
}

}  // namespace
}  // namespace vismat
