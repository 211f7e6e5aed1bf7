#include "visibility/crew.h"

#include <cstring>

#include "matrix/byte_reader.h"

namespace vismat {

std::vector<Crew::Piece> ThreadCrew::run(const std::string& stage, std::uint64_t count,
                                         const std::function<Piece(std::uint64_t)>& piece,
                                         const Progress& progress) {
  std::vector<Piece> pieces(count);
  const std::vector<std::uint64_t> missing = missing_pieces(store_, stage, pieces);
  const auto work = [&](std::uint64_t i) {
    const std::uint64_t number = missing[i];
    pieces[number] = piece(number);
    if (store_ != nullptr) store_->store(stage, number, pieces[number]);
  };
  parallel_for(missing.size(), threads_, work, progress);
  return pieces;
}

void put_ids(Crew::Piece& piece, std::span<const std::uint32_t> ids) {
  const auto count = static_cast<std::uint32_t>(ids.size());
  const std::span<const std::byte> head = std::as_bytes(std::span(&count, 1)), body = std::as_bytes(ids);
  piece.insert(piece.end(), head.begin(), head.end());
  piece.insert(piece.end(), body.begin(), body.end());
}

std::vector<std::uint32_t> take_ids(std::span<const std::byte>& bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= sizeof count) std::memcpy(&count, bytes.data(), sizeof count);
  if (bytes.size() < sizeof count || (bytes.size() - sizeof count) / sizeof count < count) {
    throw FormatError("a list of ids ends too early");
  }
  std::vector<std::uint32_t> ids(count);
  if (count > 0) std::memcpy(ids.data(), bytes.data() + sizeof count, count * sizeof count);
  bytes = bytes.subspan(sizeof count + count * sizeof count);
  return ids;
}

}  // namespace vismat
