// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_COLOUR_SPACE_H_
#define POSESPACE_DRAWING_COLOUR_SPACE_H_

#include <cstdint>

namespace posespace {

// sRGB of 8 bits <-> linear light in [0, 1] (IEC 61966-2-1), by tables.  Every 8-bit value comes
// back unchanged; linear light outside [0, 1] is clamped.
float LinearFromSrgb(std::uint8_t value);
std::uint8_t SrgbFromLinear(float light);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_COLOUR_SPACE_H_
