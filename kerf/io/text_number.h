#pragma once

namespace kerf {

/// Reads the number at the beginning of [begin, end): "1", ".5", "+1", "-1e-3", "inf", "nan". Returns where it ends, or
/// nullptr where there is none. The value is the float nearest to what the text says, of even mantissa where two are
/// equally near; beyond the range of a float it is infinity, or zero.
const char* parse_float(const char* begin, const char* end, float& value);

}  // namespace kerf
