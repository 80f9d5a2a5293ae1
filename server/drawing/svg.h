// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_SVG_H_
#define POSESPACE_DRAWING_SVG_H_

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

// What an SVG document draws.
struct DrawnSvg {
  Texture texture;  // in user units; kSvgTexels along the longer side of what is drawn, at most
  double width = 0.0, height = 0.0;  // of its canvas, user units
  std::vector<std::string> warnings;
};

inline constexpr int kSvgTexels = 1024;

// Draws an SVG document, or its gzip, with librsvg.
//
// User units are those of the viewBox, which need not begin at (0, 0); without a viewBox, CSS
// pixels of the width and height; without any of them, CSS pixels of the box around what is drawn.
// What lies outside that canvas is not drawn.  Nothing that the document refers to outside itself
// is loaded, which is reported, as is text, whose fonts are those of the machine.
//
// The drawing is done by a program of its own, posespace-svg beside the running one, with 5 s of
// processor time, 1 GiB of memory, no files to write and no way back to this process: whatever a
// document does to a renderer, it does it there.
//
// Fails     kImageUndecodable (no SVG, damaged), kImageTooLarge (unpacked beyond 32 MiB, a canvas
//           beyond 1e6 user units, beyond time or memory), kOutlineEmpty (it draws nothing),
//           kInternal (posespace-svg is not there).
// Cost      about 50 ms, and what librsvg takes.  Call from any thread that may wait.
Result<DrawnSvg> DrawSvg(std::span<const std::uint8_t> document);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_SVG_H_
