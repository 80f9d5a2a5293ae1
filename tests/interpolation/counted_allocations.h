// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_INTERPOLATION_COUNTED_ALLOCATIONS_H_
#define POSESPACE_TESTS_INTERPOLATION_COUNTED_ALLOCATIONS_H_

namespace posespace {

// How often this thread has called operator new, which the program that links this replaces.
int CountedAllocations();

}  // namespace posespace

#endif  // POSESPACE_TESTS_INTERPOLATION_COUNTED_ALLOCATIONS_H_
