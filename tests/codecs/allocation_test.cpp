// Rows are read without asking for memory, once the buffers have held the longest one. Every allocation of this program is
// counted.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/matrices.h"

namespace {
thread_local std::uint64_t allocations = 0;
}

// All forms that may meet: a sanitizer has its own of those that are not here, and they must not be mixed.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) {
  return operator new(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace vismat {
namespace {

TEST(Allocation, NoneForARow) {
  const auto matrix = test::random_matrix({100, 2000}, .1, 31);
  std::size_t codecs = 0;
  for (const Codec& codec : own_codecs()) {
    if (codec.open == nullptr) continue;
    ++codecs;
    SourceMap source;
    if (codec.needs.tree == TreeOver::rows) source.row_tree = test::even_tree(100, 2);
    const auto file = write_container(compress(matrix, codec, std::move(source)));
    const RowReader reader(file);
    RowBuffer<std::uint32_t> ids;
    RowBuffer<vismat::Run> runs;
    std::vector<std::uint64_t> bits(32);
    const auto read_all = [&] {
      for (std::uint32_t r = 0; r < 100; ++r) {
        reader.ids(r, ids);
        reader.runs(r, runs);
        reader.bits(r, bits, ids);
      }
    };
    const std::uint64_t before = allocations;
    read_all();
    EXPECT_GT(allocations, before) << codec.name << ": the buffers themselves are not counted";
    const std::uint64_t after = allocations;
    read_all();
    EXPECT_EQ(allocations, after) << codec.name;
  }
  EXPECT_GT(codecs, 15u);
}

}  // namespace
}  // namespace vismat
