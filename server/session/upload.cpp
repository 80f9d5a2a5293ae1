// SPDX-License-Identifier: Apache-2.0
#include "session/upload.h"

#include <span>
#include <utility>

#include "drawing/decode.h"
#include "drawing/outline.h"
#include "session/digest.h"

namespace posespace {
namespace {

constexpr std::string_view kImageVersion = "posespace-image/1";
constexpr std::string_view kPolygonVersion = "posespace-polygon/1";

// What a kernel function refused, as the fault of a named drawing.
Error InShape(const std::string& shape_id, std::string_view part, Error error) {
  error.message = "shape '" + shape_id + "': " + error.message;
  if (error.where.empty()) {
    error.where.push_back({"shapes['" + shape_id + "']." + std::string(part), error.message});
  }
  return error;
}

Result<Image> Decode(const std::string& shape_id, std::string_view part,
                     std::span<const std::uint8_t> bytes, const Limits& limits) {
  auto image = DecodeImage(bytes, {.max_pixels = limits.max_image_pixels});
  if (!image) return InShape(shape_id, part, std::move(image).error());
  return image;
}

Error Missing(const std::string& shape_id, std::string_view part) {
  return InShape(shape_id, part,
                 {ErrorCode::kShapeSourceMissing, "there is neither a picture nor a polygon", {}});
}

Result<Drawing> FromImage(const std::string& shape_id, const ImageSource& source,
                          const Limits& limits) {
  if (source.data.empty()) return Missing(shape_id, "image");
  auto image = TRY(Decode(shape_id, "image", source.data, limits));
  auto outline =
      TraceOutline(image, {.threshold = source.threshold, .max_points = limits.max_outline_points});
  if (!outline) return InShape(shape_id, "outline", std::move(outline).error());
  Drawing drawing;
  drawing.width = image.width;
  drawing.height = image.height;
  drawing.outline = std::move(*outline);
  drawing.texture.image = std::move(image);
  return drawing;
}

Result<Drawing> FromPolygon(const std::string& shape_id, const PolygonSource& source,
                            const Limits& limits) {
  if (source.outer.rows() == 0) return Missing(shape_id, "outline");
  auto outline =
      OutlineFromRings(source.outer, source.holes, {.max_points = limits.max_outline_points});
  if (!outline) return InShape(shape_id, "outline", std::move(outline).error());
  Drawing drawing;
  drawing.outline = std::move(*outline);
  if (source.texture.empty()) {
    const Point size =
        drawing.outline.outer.colwise().maxCoeff() - drawing.outline.outer.colwise().minCoeff();
    drawing.width = size.x();
    drawing.height = size.y();
    drawing.texture = PaintRings(drawing.outline);
  } else {
    drawing.texture.image = TRY(Decode(shape_id, "texture", source.texture, limits));
    drawing.width = drawing.texture.image.width;
    drawing.height = drawing.texture.image.height;
  }
  return drawing;
}

}  // namespace

std::string SourceDigest(const ShapeSource& source) {
  if (const auto* image = std::get_if<ImageSource>(&source)) {
    return Digest(kImageVersion)
        .Add(std::span<const std::uint8_t>(image->data))
        .Add(static_cast<std::int64_t>(image->threshold))
        .Hex();
  }
  const auto& polygon = std::get<PolygonSource>(source);
  Digest digest(kPolygonVersion);
  digest.Add(polygon.outer).Add(static_cast<std::int64_t>(polygon.holes.size()));
  for (const Points& hole : polygon.holes) digest.Add(hole);
  return digest.Add(std::span<const std::uint8_t>(polygon.texture)).Hex();
}

Result<Drawing> ReadDrawing(const std::string& shape_id, const ShapeSource& source,
                            const Limits& limits) {
  const auto* image = std::get_if<ImageSource>(&source);
  Drawing drawing =
      TRY(image != nullptr ? FromImage(shape_id, *image, limits)
                           : FromPolygon(shape_id, std::get<PolygonSource>(source), limits));
  drawing.id = shape_id;
  drawing.digest = SourceDigest(source);
  return drawing;
}

}  // namespace posespace
