// What the tables of codecs do not try on others' compressors: hostile payloads, wide rows, and programs.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <string>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/baselines/program_codecs.h"
#include "codecs/rows/row_codec.h"
#include "tests/codecs/matrices.h"
#include "tests/matrix/temporary_folder.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

using Payload = std::vector<std::byte>;

// Codecs that give rows: all of them in parts of equal length.
VisibilityMatrix decode(const Codec& codec, const Payload& payload, Shape shape) {
  Encoded encoded{payload};
  if (codec.open != nullptr)
    put_varint(encoded.index, (shape.rows + codec.rows_per_part - 1) / codec.rows_per_part);
  return vismat::decode(codec, encoded, shape);
}
VisibilityMatrix decode(std::string_view codec, const Payload& payload, Shape shape) {
  return decode(find_codec(codec), payload, shape);
}

void expect_refused(std::string_view codec, const Payload& payload, Shape shape, std::string_view why) {
  try {
    decode(codec, payload, shape);
    ADD_FAILURE() << codec << " does not find: " << why;
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

// Numbers of `width` bytes each, lowest first.
struct Field {
  unsigned width;
  std::vector<std::uint32_t> numbers;
};
Payload payload_of(std::initializer_list<Field> fields) {
  Payload out;
  for (const Field& field : fields) {
    for (const std::uint32_t number : field.numbers) {
      for (unsigned i = 0; i < field.width; ++i) out.push_back(static_cast<std::byte>(number >> (8 * i)));
    }
  }
  return out;
}

// 8 MB in a few kilobytes. A decoder that is told of a small matrix stops behind it: otherwise it would complain of the
// size of the whole.
TEST(WholeFileBaselines, StopBehindTheSizeOfTheShape) {
  const VisibilityMatrix zeros(Shape{1u << 12, 1u << 14});
  for (const char* name : {"gzip", "bzip2", "xz", "zstd", "brotli"}) {
    const Payload payload = find_codec(name).encode(zeros, {}, {}).payload;
    EXPECT_LT(payload.size(), 10'000u) << name;
    expect_refused(name, payload, {3, 5}, "or not the 3 bytes of its shape");
    expect_refused(name, payload, {1u << 13, 1u << 14}, "");
  }
}

// A row's payload is the same for any number of rows, so one row of many columns is a hostile row of few.
TEST(RowBaselines, StopBehindTheRow) {
  const VisibilityMatrix zeros(Shape{1, 1u << 26});
  for (const char* name : {"gzip-rows", "zstd-rows", "zstd-dict", "unreal-chunks"}) {
    const Payload payload = find_codec(name).encode(zeros, {}, {}).payload;
    EXPECT_LT(payload.size(), 10'000u) << name;
    EXPECT_EQ(decode(name, payload, {1, 1u << 26}), zeros) << name;
    expect_refused(name, payload, {1, 20}, "row 0");
    expect_refused(name, payload, {1, 1u << 27}, "row 0");
  }
}

TEST(UnrealChunks, RefusesChunksOfOtherRows) {
  const auto matrix = test::random_matrix({100, 30}, .5, 1);
  const Encoded good = find_codec("unreal-chunks").encode(matrix, {}, {});
  EXPECT_THROW(vismat::decode(find_codec("unreal-chunks"), good, {99, 30}), FormatError);
  EXPECT_THROW(vismat::decode(find_codec("unreal-chunks"), good, {101, 30}), FormatError);
  EXPECT_THROW(vismat::decode(find_codec("unreal-chunks"), good, {100, 31 + 8}), FormatError);
  // Of 100 rows the last chunk holds 36; the first must not.
  const Payload chunk =
      find_codec("unreal-chunks").encode(test::random_matrix({36, 30}, .5, 1), {}, {}).payload;
  Payload twice = chunk;
  twice.insert(twice.end(), chunk.begin(), chunk.end());
  expect_refused("unreal-chunks", twice, {100, 30}, "row 36: a chunk inflates to 144 bytes");
}

// Frames are magicless: a head of two bytes, then blocks of which the first bit marks the last, here raw and of one byte.
TEST(ZstdRows, RefusesWhatIsNotOneBareFrame) {
  const Payload good = payload_of({{1, {0, 0}}, {3, {1 << 3 | 1}}, {1, {0x05}}});
  EXPECT_EQ(decode("zstd-rows", good, {1, 8}), VisibilityMatrix::from_rows({{0, 2}}, 8));
  Payload twice = good;
  twice.insert(twice.end(), good.begin(), good.end());
  expect_refused("zstd-rows", twice, {1, 16}, "after the frame");
  Payload sized = good;
  sized[0] = std::byte{0x20};
  expect_refused("zstd-rows", sized, {1, 8}, "a frame with a size");
  const Payload legacy = payload_of({{4, {0xFD2FB527}}, {4, {0, 0, 0}}});  // zstd 0.7
  expect_refused("zstd-rows", legacy, {1, 8}, "a frame with a size");
  expect_refused("zstd-rows", payload_of({{1, {0, 0}}, {3, {9 << 3 | 1}}, {1, {5}}}), {1, 8},
                 "needs 9 more bytes");
}

TEST(ZstdDict, IsSmallerWhereRowsAreAlike) {
  const auto matrix = test::clustered_matrix({3000, 800}, 2);
  EXPECT_LT(find_codec("zstd-dict").encode(matrix, {}, {}).payload.size(),
            find_codec("zstd-rows").encode(matrix, {}, {}).payload.size());
}

// Rows over several containers of 2^16 columns, in all three forms and where runs cross from one to the next.
TEST(Roaring, KeepsWideRows) {
  constexpr std::uint32_t columns = 3 * 65536 + 100;
  std::vector<std::vector<std::uint32_t>> rows(7);
  for (std::uint32_t c = 0; c < columns; ++c) {
    rows[0].push_back(c);
    if (c % 2 == 0) rows[1].push_back(c);
    if (c % 1000 == 999) rows[2].push_back(c);
    if (c >= 65000 && c < 66000) rows[3].push_back(c);
    if (c % 65536 == 65535) rows[4].push_back(c);
    if (c % 16 == 0 && c / 65536 == 1) rows[5].push_back(c);  // 4096: the largest array
  }
  const auto matrix = VisibilityMatrix::from_rows(rows, columns);
  const Encoded encoded = find_codec("roaring").encode(matrix, {}, {});
  EXPECT_EQ(vismat::decode(find_codec("roaring"), encoded, matrix.shape()), matrix);
}

TEST(Roaring, RefusesWhatTheLibraryWouldTrust) {
  constexpr Shape shape{1, 200'000};
  const auto array = [](std::vector<std::uint32_t> head, std::vector<std::uint32_t> ids) {
    return payload_of({{4, {12346, 1}}, {2, head}, {4, {16}}, {2, ids}});
  };
  EXPECT_EQ(decode("roaring", array({1, 2}, {3, 5, 9}), shape),
            VisibilityMatrix::from_rows({{65539, 65541, 65545}}, shape.columns));
  expect_refused("roaring", array({1, 2}, {3, 9, 5}), shape, "ids do not ascend");
  expect_refused("roaring", array({1, 2}, {3, 3, 5}), shape, "ids do not ascend");
  expect_refused("roaring", array({1, 3}, {3, 5, 9}), shape, "needs 8 more bytes");
  expect_refused("roaring", array({1, 1}, {3, 5, 9}), shape, "bytes after the bitmap");
  expect_refused("roaring", array({9, 2}, {3, 5, 9}), shape, "column 589827 in a row of 200000");
  expect_refused("roaring", payload_of({{4, {12346, 1}}, {2, {1, 0}}, {4, {17}}, {2, {3}}}), shape,
                 "not where container 0");
  expect_refused("roaring", payload_of({{4, {12346, 2}}, {2, {1, 0, 1, 0}}, {4, {24, 26}}, {2, {3, 3}}}),
                 shape, "containers do not ascend");
  expect_refused("roaring", payload_of({{4, {12346, 65537}}}), shape, "65537 containers");
  expect_refused("roaring", payload_of({{4, {12345, 0}}}), shape, "no Roaring bitmap");

  const auto runs = [](std::uint32_t ones, std::vector<std::uint32_t> pairs) {
    return payload_of({{4, {12347}},
                       {1, {1}},
                       {2, {0, ones - 1, static_cast<std::uint32_t>(pairs.size() / 2)}},
                       {2, pairs}});
  };
  EXPECT_EQ(decode("roaring", runs(5, {3, 1, 9, 2}), shape),
            VisibilityMatrix::from_rows({{3, 4, 9, 10, 11}}, shape.columns));
  expect_refused("roaring", runs(6, {3, 1, 9, 2}), shape, "5 ones where 6 are announced");
  expect_refused("roaring", runs(5, {9, 2, 3, 1}), shape, "runs overlap");
  expect_refused("roaring", runs(5, {3, 1, 5, 2}), shape, "runs overlap, touch");
  expect_refused("roaring", runs(5, {65533, 4}), shape, "leave their container");
  expect_refused("roaring", payload_of({{4, {12347}}, {1, {2}}, {2, {0, 0, 1, 3, 0}}}), shape,
                 "a container that is not there");

  Payload bitset = payload_of({{4, {12346, 1}}, {2, {0, 4999}}, {4, {16}}});
  bitset.resize(bitset.size() + 8192, std::byte{0});
  std::fill_n(bitset.begin() + 16, 625, std::byte{0xff});
  EXPECT_EQ(decode("roaring", bitset, shape).ones(), 5000u);
  bitset.back() = std::byte{1};
  expect_refused("roaring", bitset, shape, "5001 ones where 5000 are announced");
}

TEST(StreamVByte, RefusesWhatTheLibraryWouldTrust) {
  constexpr Shape shape{1, 700};
  const Payload good = payload_of({{1, {2, 1}}, {2, {301}}, {1, {7}}});
  std::vector<std::uint32_t> ids;
  for (std::uint32_t c = 300; c < 307; ++c) ids.push_back(c);
  EXPECT_EQ(decode("streamvbyte", good, shape), VisibilityMatrix::from_rows({ids}, 700));
  expect_refused("streamvbyte", payload_of({{1, {9, 1, 1, 1, 7}}}), shape, "9 numbers are announced");
  expect_refused("streamvbyte", payload_of({{1, {2, 3, 1, 1, 7}}}), shape, "not the 5 announced");
  expect_refused("streamvbyte", payload_of({{1, {2, 0, 1, 7, 7}}}), shape, "not the 2 announced");
  expect_refused("streamvbyte", payload_of({{1, {2, 0x40, 1, 7, 0}}}), shape, "control bits behind");
  expect_refused("streamvbyte", payload_of({{1, {2, 0, 1, 0}}}), shape, "a zero among");
  expect_refused("streamvbyte", payload_of({{1, {1, 0, 1}}}), shape, "a gap without a run");
  expect_refused("streamvbyte", payload_of({{1, {2, 15}}, {4, {0xffffffff, 0xffffffff}}}), shape,
                 "in a row of 700");
}

// --- programs

class ProgramCodecs : public testing::TestWithParam<Codec> {
 protected:
  // Whatever a program writes ends up under this folder.
  void SetUp() override {
    if (!available()) GTEST_SKIP() << GetParam().name << " is not installed";
    ::setenv("TMPDIR", (folder_ / "").c_str(), 1);
  }
  void TearDown() override {
    ::unsetenv("TMPDIR");
    EXPECT_EQ(folder_.entries(), 0u) << "files are left";
  }
  bool available() const { return codec_named(GetParam().name, available_program_codecs()) != nullptr; }
  TemporaryFolder folder_;
};

TEST_P(ProgramCodecs, RoundTrips) {
  const auto all = test::assorted_matrices();
  for (std::size_t i = 0; i < all.size(); i += test::sanitized ? 2 : 1) {  // no sanitizer is in the program
    const auto& [name, matrix] = all[i];
    const Encoded encoded = GetParam().encode(matrix, {}, {});
    EXPECT_EQ(vismat::decode(GetParam(), encoded, matrix.shape()), matrix) << name;
  }
  const auto matrix = test::clustered_matrix({50, 90}, 3);
  EXPECT_EQ(GetParam().encode(matrix, {}, {}), GetParam().encode(matrix, {}, {}));
}

TEST_P(ProgramCodecs, RefusesDamageAndOtherShapes) {
  const auto matrix = test::clustered_matrix({50, 90}, 3);
  const Payload good = GetParam().encode(matrix, {}, {}).payload;
  const auto decode = [&](const Payload& payload, Shape shape) {
    return vismat::decode(GetParam(), {payload}, shape);
  };
  EXPECT_THROW(decode(good, {50, 100}), FormatError);
  EXPECT_THROW(decode(good, {51, 90}), FormatError);
  EXPECT_THROW(decode({}, {50, 90}), FormatError);
  EXPECT_THROW(decode(Payload(good.begin(), good.begin() + 10), {50, 90}), FormatError);
}

TEST_P(ProgramCodecs, SaysWhatIsMissing) {
  const std::string path = ::getenv("PATH");
  ::setenv("PATH", (folder_ / "").c_str(), 1);
  EXPECT_FALSE(available());
  try {
    GetParam().encode(VisibilityMatrix::from_rows({{0}}, 1), {}, {});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is not installed (Debian package "), std::string::npos)
        << error.what();
  }
  ::setenv("PATH", path.c_str(), 1);
}

INSTANTIATE_TEST_SUITE_P(Table, ProgramCodecs, testing::ValuesIn(program_codecs()), test::table_name);

}  // namespace
}  // namespace vismat
