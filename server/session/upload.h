// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_UPLOAD_H_
#define POSESPACE_SESSION_UPLOAD_H_

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "session/limits.h"
#include "session/pose_space.h"

namespace posespace {

// Source of a drawing.
struct ImageSource {
  std::vector<std::uint8_t> data;  // a picture file
  int threshold = 128;             // alpha from which a pixel is painted, 1 .. 255
};
struct PolygonSource {
  Points outer;
  std::vector<Points> holes;
  std::vector<std::uint8_t> texture;  // a picture file, or empty
};
using ShapeSource = std::variant<ImageSource, PolygonSource>;

// Digest of a source and its options; equal sources have equal digests.
std::string SourceDigest(const ShapeSource& source);

// Decodes and traces an upload.  Pure; call from any thread.
// Fails  as DecodeImage and TraceOutline or OutlineFromRings do, with the shape's name in the
//        message and a field such as "shapes['walk'].outline"; kShapeSourceMissing (no bytes, no
//        points).
Result<Drawing> ReadDrawing(const std::string& shape_id, const ShapeSource& source,
                            const Limits& limits);

}  // namespace posespace

#endif  // POSESPACE_SESSION_UPLOAD_H_
