// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_UPLOAD_H_
#define POSESPACE_SESSION_UPLOAD_H_

#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "drawing/foreground.h"
#include "geometry/mesh.h"
#include "geometry/result.h"
#include "session/limits.h"
#include "session/pose_space.h"

namespace posespace {

// Sources of a drawing, as the caller sent them; plain values, so that they can be kept and read
// again.
struct ImageSource {
  std::vector<std::uint8_t> data;  // a picture file
  ForegroundOptions options = {};
};
struct SvgSource {
  std::vector<std::uint8_t> document;  // SVG, or its gzip
  ForegroundOptions options = {};
};
struct PolygonSource {
  Points outer;
  std::vector<Points> holes;
  std::vector<std::uint8_t> texture;  // a picture file, or empty
};
using ShapeSource = std::variant<ImageSource, SvgSource, PolygonSource>;

// Digest of a source and its options; equal sources have equal digests.
std::string SourceDigest(const ShapeSource& source);

// Decodes and traces an upload.  `pixels_left` is what the session's pictures may still have: a
// picture with more is refused by its header.  Pure; call from any thread.
// Fails  as DecodeImage, DrawSvg, CutOut, TraceOutline or OutlineFromRings do, with the shape's
// name in the
//        message and fields of PutShapeRequest: image.data, image.threshold, svg.document,
//        polygon.outer[17],
//        polygon.holes[2][5], polygon.texture; kShapeSourceMissing (no bytes, no points).
Result<Drawing> ReadDrawing(const std::string& shape_id, const ShapeSource& source,
                            const Limits& limits,
                            std::int64_t pixels_left = std::numeric_limits<std::int64_t>::max());

}  // namespace posespace

#endif  // POSESPACE_SESSION_UPLOAD_H_
