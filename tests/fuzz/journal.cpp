// Any bytes as a journal: the whole records are those that, written again, give the same bytes. Checksums are made right
// first, or nearly every mutation would end at the first.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/checksum.h"
#include "visibility/jobs/journal.h"

namespace {

// Writes the checksum of `size` bytes, if there are so many, before them.
bool seal(std::span<std::byte> bytes, std::uint64_t at, std::uint64_t size) {
  if (at > bytes.size() || bytes.size() - at < 4 || bytes.size() - at - 4 < size) return false;
  const std::uint32_t sum = vismat::crc32(bytes.subspan(at + 4, size));
  std::memcpy(bytes.data() + at, &sum, 4);
  return true;
}

template <typename Number>
Number number_or_0(std::span<const std::byte> bytes, std::uint64_t at) {
  const bool there = at <= bytes.size() && bytes.size() - at >= sizeof(Number);
  return there ? vismat::number_at<Number>(bytes, at) : 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  std::uint64_t end = 16 + std::uint64_t{number_or_0<std::uint32_t>(file, 12)};
  bool fits = seal(file, 8, end - 12);
  while (fits) {
    const std::uint64_t piece = number_or_0<std::uint64_t>(file, end + 16);
    const std::uint64_t record = 24 + std::uint64_t{number_or_0<std::uint32_t>(file, end + 4)};
    if (piece > file.size()) break;
    fits = seal(file, end, record - 4 + piece);
    end += record + piece;
  }
  try {
    const JournalContents contents = read_journal(file);
    std::vector<std::byte> again = journal_head(contents.work);
    for (const JournalContents::Record& record : contents.records) {
      const std::vector<std::byte> bytes = journal_record(record);
      again.insert(again.end(), bytes.begin(), bytes.end());
    }
    if (!std::ranges::equal(again, std::span(file).first(contents.end))) std::abort();
  } catch (const FormatError&) {
  }
  return 0;
}
