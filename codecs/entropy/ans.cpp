#include "codecs/entropy/ans.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "codecs/entropy/bit_stream.h"

namespace vismat {

AnsTable::AnsTable(const Shares& shares) : shares_(shares), back_{} {
  steps_.assign(states, Step{0, 0, LengthSymbol::count});
  std::uint32_t place = 0;
  for (std::uint32_t s = 0; s < shares.size(); ++s) {
    for (std::uint32_t i = 0; i < shares[s]; ++i) {
      steps_[place].symbol = static_cast<std::uint8_t>(s);
      place = (place + states / 2 + states / 8 + 3) % states;
    }
  }
  std::uint32_t before = 0;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    if (shares[s] == 0) continue;
    const unsigned most = state_bits + 1 - static_cast<unsigned>(std::bit_width(shares[s]));
    back_[s] = {(most << 16) - (shares[s] << most), before - shares[s]};
    before += shares[s];
  }
  places_.resize(states);
  Shares met{};
  for (std::uint32_t state = 0; state < states; ++state) {
    Step& step = steps_[state];
    if (step.symbol == LengthSymbol::count) continue;
    const std::uint32_t rank = met[step.symbol]++, t = shares[step.symbol] + rank;
    places_[t + back_[step.symbol].first_place] = static_cast<std::uint16_t>(state);
    step.bits = static_cast<std::uint8_t>(state_bits + 1 - std::bit_width(t));
    step.next = static_cast<std::uint16_t>((t << step.bits) - states);
  }
}

AnsTable AnsTable::from_counts(const Counts& counts) {
  const auto sum = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  if (sum == 0) return {};
  Shares shares{};
  auto left = static_cast<std::int32_t>(states);
  for (std::size_t s = 0; s < shares.size(); ++s) {
    if (counts[s] == 0) continue;
    shares[s] = std::max(1u, static_cast<std::uint32_t>(static_cast<double>(counts[s]) / sum * states));
    left -= static_cast<std::int32_t>(shares[s]);
  }
  // The largest shares take what rounding left over or took too much, since there it matters least.
  while (left != 0) {
    const auto top = std::max_element(shares.begin(), shares.end());
    const std::int32_t step = left > 0 ? left : -std::min(-left, static_cast<std::int32_t>((*top + 1) / 2));
    *top = static_cast<std::uint32_t>(static_cast<std::int32_t>(*top) + step);
    left -= step;
  }
  const auto top = std::max_element(shares.begin(), shares.end());
  if (*top == states) {
    --*top;
    ++shares[top == shares.begin() ? 1 : 0];
  }
  return AnsTable(shares);
}

void AnsTable::write(std::vector<std::byte>& out) const {
  std::size_t last = shares_.size();
  while (last > 0 && shares_[last - 1] == 0) --last;
  put_varint(out, last);
  for (std::size_t s = 0; s < last; ++s) put_varint(out, shares_[s]);
}

AnsTable AnsTable::read(ByteReader& in) {
  const std::uint64_t last = in.varint();
  Shares shares{};
  if (last > shares.size())
    in.fail("shares of " + std::to_string(last) + " symbols; there are " + std::to_string(shares.size()));
  std::uint32_t sum = 0;
  for (std::uint64_t s = 0; s < last; ++s) {
    const std::uint64_t share = in.varint();
    if (share >= states || sum + share > states)
      in.fail("a symbol with all states, or more states than there are");
    shares[s] = static_cast<std::uint32_t>(share);
    sum += shares[s];
  }
  if (last > 0 && (sum != states || shares[last - 1] == 0))
    in.fail("the shares sum to " + std::to_string(sum) + ", not to " + std::to_string(states) +
            ", or the last is none");
  return AnsTable(shares);
}

void AnsCode::write_model(std::vector<std::byte>& out) {
  for (std::size_t which = 0; which < 2; ++which) {
    tables_[which] = AnsTable::from_counts(counts_[which]);
    tables_[which].write(out);
  }
}

void AnsCode::read_model(ByteReader& in) {
  for (AnsTable& table : tables_) table = AnsTable::read(in);
}

void AnsCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  steps_of_list_.resize(numbers.size());
  std::uint32_t state = 0;
  for (std::size_t i = numbers.size(); i-- > 0;) {
    const LengthSymbol s = symbol_of_length(numbers[i]);
    const AnsTable::Bits step = tables_[i % 2].step_back(state, s.symbol);
    steps_of_list_[i] = {step.bits | std::uint64_t{s.raw} << step.count, step.count + s.raw_count};
  }
  ListWriter bits(out);
  bits.put(state, AnsTable::state_bits);
  for (const AnsTable::Bits& number : steps_of_list_) bits.put(number.bits, number.count);
  bits.finish();
}

AnsCode::Reader::Reader(const AnsCode& code, std::span<const std::byte> bytes)
    : bits_(bytes, "ANS", AnsTable::state_bits), tables_{&code.tables_[0], &code.tables_[1]} {
  if (bytes.empty()) return;
  state_ = static_cast<std::uint32_t>(lowest_bits(bits_.peek(), AnsTable::state_bits));
  bits_.take(AnsTable::state_bits);
  if (bits_.ended() && state_ == 0) bits_.fail("bits, but no number");
}

std::size_t AnsCode::Reader::read(std::span<std::uint32_t> out) {
  ListBits bits = bits_;  // kept in registers
  auto [now, other] = tables_;
  std::uint32_t state = state_;
  std::uint32_t* to = out.data();
  std::uint32_t* const end = to + out.size();
  while (to != end) {
    if (bits.ended()) [[unlikely]] {
      bits.check();
      if (state == 0) break;
    }
    const AnsTable::Step step = now->step(state);
    std::swap(now, other);
    std::uint64_t ahead = bits.peek();
    state = step.next + static_cast<std::uint32_t>(lowest_bits(ahead, step.bits));
    bits.take(step.bits);
    if (step.symbol < 64) [[likely]] {
      *to++ = step.symbol + 1u;
      continue;
    }
    if (step.symbol == LengthSymbol::count) bits.fail("a number of a kind that no list has");
    const unsigned raw = raw_bits_of_symbol(step.symbol);
    ahead >>= step.bits;
    *to++ = length_of_symbol(step.symbol, static_cast<std::uint32_t>(lowest_bits(ahead, raw)));
    bits.take(raw);
  }
  bits_ = bits;
  tables_ = {now, other};
  state_ = state;
  return static_cast<std::size_t>(to - out.data());
}

}  // namespace vismat
