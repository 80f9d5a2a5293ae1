// SPDX-License-Identifier: Apache-2.0
#include "mapping/ring_programme.h"

#include "mapping/visibility.h"

namespace posespace {

void ChordTable::KeepChordsInside(const Points& ring) {
  for (int i = 0; i < n_; ++i) {
    for (int j = i + 2; j < n_; ++j) {
      if (i == 0 && j == n_ - 1) continue;
      if (Allows(i, j) && !(StartsInside(ring, i, j) && StartsInside(ring, j, i))) Forbid(i, j);
    }
  }
}

}  // namespace posespace
