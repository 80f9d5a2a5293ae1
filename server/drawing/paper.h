// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_PAPER_H_
#define POSESPACE_DRAWING_PAPER_H_

#include <string>
#include <vector>

#include "drawing/image.h"

namespace posespace {

// Makes the paper around a drawing transparent when the picture is a sheet of it, as CutOut in
// foreground.h says, and answers what was done in words; nothing when the picture is no such sheet,
// or would be all paper.  `threshold` is the alpha from which a pixel is painted.
std::vector<std::string> RemovePaper(Texture* texture, int threshold);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_PAPER_H_
