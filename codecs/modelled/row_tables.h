// The weights under which modelled rows are coded. 'bench train-rows' makes row_tables.cpp from many matrices; no weight
// depends on the file that is coded.
#pragma once
#include <array>
#include <cstdint>

namespace vismat {

inline constexpr std::uint32_t row_weight_count = 7068;
using RowWeights = std::array<std::int8_t, row_weight_count>;
/// In units of 1/16: the sum of a decision's weights is the natural logarithm of its odds. row_model.h says what each
/// weight stands for.
extern const RowWeights row_weights;

/// chance_of_sum[512 + s], for the sum s of at most four weights, is the probability of a 1 in units of 2^-16.
extern const std::array<std::uint16_t, 1024> chance_of_sum;

}  // namespace vismat
