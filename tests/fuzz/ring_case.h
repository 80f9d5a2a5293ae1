// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_FUZZ_RING_CASE_H_
#define POSESPACE_TESTS_FUZZ_RING_CASE_H_

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "mapping/boundary_matching.h"
#include "tests/mapping/outline_families.h"

namespace posespace {

// What a client may send: rings, as they come, and landmarks over any of them.
struct RingCase {
  std::vector<Points> rings;
  std::vector<Landmark> landmarks;
};

// A case as text, one ring or landmark a line, coordinates to the last bit:
//
//   ring 0x1p+0 0x0p+0 ...      x y of each row
//   landmark 0:1,2 3:0.5,7      drawing:x,y of each mark
std::string TextOf(const RingCase& input);
RingCase CaseOf(std::istream& in);

// 2 to 8 rings: members of all families, the bat and the star, with collinear runs, near
// duplicates, zigzags, spikes and odd scales worked into them; now and then one that crosses
// itself.
RingCase DrawRings(Random& random);

// A few well-behaved rings and random landmarks over any subsets: on corners and sides, off the
// outline, coincident, contradictory, not finite.
RingCase DrawLandmarks(Random& random);

}  // namespace posespace

#endif  // POSESPACE_TESTS_FUZZ_RING_CASE_H_
