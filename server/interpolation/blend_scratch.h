// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BLEND_SCRATCH_H_
#define POSESPACE_INTERPOLATION_BLEND_SCRATCH_H_

#include "interpolation/blend_kernel.h"

namespace posespace {

// This thread's memory for `lanes` poses at once: the same again and again, as large as the largest
// that was asked for.  Valid until the thread asks again.
BlendScratch ThreadScratch(const BlendTables& tables, int lanes);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BLEND_SCRATCH_H_
