// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_FOREGROUND_H_
#define POSESPACE_DRAWING_FOREGROUND_H_

#include <optional>
#include <string>
#include <vector>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

// Which pixels of a picture are the drawing; see Foreground in session_service.proto.
enum class Foreground { kAlpha, kLight, kDark };

struct ForegroundOptions {
  Foreground foreground = Foreground::kAlpha;
  // From where on a pixel is painted, 1 .. 255: its alpha, by default 128; or its distance from the
  // background in brightness, by default half of the largest in the picture.
  std::optional<int> threshold;
};

// A picture of which only the drawing is opaque.
struct Cutout {
  Texture texture;
  int threshold = 128;                // alpha from which a pixel is painted
  std::vector<std::string> warnings;  // what was done, for a person to read
};

// Makes what is not the drawing transparent.
//
//   alpha        nothing is done, unless the picture is a sheet of paper: at least 98 % of the box
//                around what is painted are opaque, that box is at least 90 % of the picture, and
//                at least 60 % of its frame have one colour.  Then what has this colour (within
//                0.12 of each channel's range) and hangs together with the frame goes.  Regions of
//                the paper's colour inside the drawing stay, since eyes and shirts are more common
//                than gaps, and are reported.
//   light, dark  the background's colour is the commonest of the frame; whatever is not lighter
//                (darker) than it by the threshold goes, regions inside the drawing included.
//                Brightness is Rec. 601 luma of the samples; a transparent picture is taken to lie
//                on black (white).
//
// Edges stay smooth and lose the background's colour (soft_edge.h).
//
// Fails     kOutlineEmpty (nothing differs from the background), kInvalidOption (threshold).
// Cost      a few passes over the picture.
Result<Cutout> CutOut(Texture texture, const ForegroundOptions& options = {});

}  // namespace posespace

#endif  // POSESPACE_DRAWING_FOREGROUND_H_
