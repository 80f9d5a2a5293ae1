// SPDX-License-Identifier: Apache-2.0
#include "session/upload.h"

#include <algorithm>
#include <span>
#include <utility>

#include "drawing/decode.h"
#include "drawing/outline.h"
#include "drawing/svg.h"
#include "session/digest.h"

namespace posespace {
namespace {

constexpr std::string_view kImageVersion = "posespace-image/2";
constexpr std::string_view kSvgVersion = "posespace-svg/1";
constexpr std::string_view kPolygonVersion = "posespace-polygon/2";

// One upload being read.
struct Upload {
  const std::string& shape_id;
  const Limits& limits;
  std::int64_t pixels_left;
};

// What a kernel function refused, as the fault of a named drawing and of a field of the request:
// the kernel's own field within `message`, or `field` where it names none.
Error InRequest(const Upload& upload, const std::string& message, const std::string& field,
                Error error) {
  error.message = "shape '" + upload.shape_id + "': " + error.message;
  for (Violation& violation : error.where) violation.field = message + "." + violation.field;
  if (error.where.empty()) error.where.push_back({message + "." + field, error.message});
  return error;
}

Error Missing(const Upload& upload, const std::string& message, const std::string& field) {
  return InRequest(upload, message, field,
                   {ErrorCode::kShapeSourceMissing, "there is nothing in " + message, {}});
}

// Says why a picture within the limit is too large all the same, if that is so.
Error WithPixelsLeft(const Upload& upload, Error refused) {
  if (refused.code == ErrorCode::kImageTooLarge &&
      upload.pixels_left < upload.limits.max_image_pixels) {
    refused.message += ", since the session's other pictures have taken the rest of " +
                       std::to_string(upload.limits.max_session_pixels);
  }
  return refused;
}

Result<DecodedImage> Decode(const Upload& upload, const std::string& message,
                            const std::string& field, std::span<const std::uint8_t> bytes) {
  auto image = DecodeImage(
      bytes, {.max_pixels = std::min(upload.limits.max_image_pixels, upload.pixels_left)});
  if (image) return image;
  return InRequest(upload, message, field, WithPixelsLeft(upload, std::move(image).error()));
}

void Append(std::vector<std::string> more, std::vector<std::string>* warnings) {
  warnings->insert(warnings->end(), std::make_move_iterator(more.begin()),
                   std::make_move_iterator(more.end()));
}

// Cuts the drawing out of its picture and traces it.
Result<Drawing> FromTexture(const Upload& upload, const std::string& message,
                            const std::string& field, Texture texture,
                            const ForegroundOptions& options) {
  auto cutout = CutOut(std::move(texture), options);
  if (!cutout) return InRequest(upload, message, field, std::move(cutout).error());
  auto outline = TraceOutline(cutout->texture, {.threshold = cutout->threshold,
                                                .max_points = upload.limits.max_outline_points});
  if (!outline) return InRequest(upload, message, field, std::move(outline).error());
  Drawing drawing;
  drawing.outline = std::move(*outline);
  std::swap(drawing.outline.warnings, cutout->warnings);
  Append(std::move(cutout->warnings), &drawing.outline.warnings);
  drawing.texture = std::move(cutout->texture);
  return drawing;
}

Result<Drawing> Read(const Upload& upload, const ImageSource& source) {
  if (source.data.empty()) return Missing(upload, "image", "data");
  DecodedImage image = TRY(Decode(upload, "image", "data", source.data));
  const int width = image.width, height = image.height;
  std::vector<std::string> warnings = std::move(image.warnings);
  Drawing drawing = TRY(FromTexture(upload, "image", "data",
                                    Texture{std::move(image), {0.0, 0.0}, 1.0}, source.options));
  drawing.width = width;
  drawing.height = height;
  Append(std::exchange(drawing.outline.warnings, std::move(warnings)), &drawing.outline.warnings);
  return drawing;
}

Result<Drawing> Read(const Upload& upload, const SvgSource& source) {
  if (source.document.empty()) return Missing(upload, "svg", "document");
  auto drawn = DrawSvg(source.document);
  if (!drawn) return InRequest(upload, "svg", "document", std::move(drawn).error());
  Drawing drawing =
      TRY(FromTexture(upload, "svg", "document", std::move(drawn->texture), source.options));
  drawing.width = drawn->width;
  drawing.height = drawn->height;
  Append(std::exchange(drawing.outline.warnings, std::move(drawn->warnings)),
         &drawing.outline.warnings);
  return drawing;
}

Result<Drawing> Read(const Upload& upload, const PolygonSource& source) {
  if (source.outer.rows() == 0) return Missing(upload, "polygon", "outer");
  auto outline = OutlineFromRings(source.outer, source.holes,
                                  {.max_points = upload.limits.max_outline_points});
  if (!outline) return InRequest(upload, "polygon", "outer", std::move(outline).error());
  Drawing drawing;
  drawing.outline = std::move(*outline);
  if (source.texture.empty()) {
    const Point size = source.outer.colwise().maxCoeff() - source.outer.colwise().minCoeff();
    drawing.width = size.x();
    drawing.height = size.y();
    drawing.texture = PaintRings(source.outer, source.holes);
  } else {
    DecodedImage image = TRY(Decode(upload, "polygon", "texture", source.texture));
    Append(std::move(image.warnings), &drawing.outline.warnings);
    drawing.texture.image = std::move(image);
    drawing.width = drawing.texture.image.width;
    drawing.height = drawing.texture.image.height;
  }
  return drawing;
}

std::string DigestOf(std::string_view version, std::span<const std::uint8_t> bytes,
                     const ForegroundOptions& options) {
  return Digest(version)
      .Add(bytes)
      .Add(static_cast<std::int64_t>(options.foreground))
      .Add(static_cast<std::int64_t>(options.threshold.value_or(-1)))
      .Hex();
}

std::string DigestOf(const ImageSource& source) {
  return DigestOf(kImageVersion, source.data, source.options);
}

std::string DigestOf(const SvgSource& source) {
  return DigestOf(kSvgVersion, source.document, source.options);
}

std::string DigestOf(const PolygonSource& source) {
  Digest digest(kPolygonVersion);
  digest.Add(source.outer).Add(static_cast<std::int64_t>(source.holes.size()));
  for (const Points& hole : source.holes) digest.Add(hole);
  return digest.Add(std::span<const std::uint8_t>(source.texture)).Hex();
}

}  // namespace

std::string SourceDigest(const ShapeSource& source) {
  return std::visit([](const auto& given) { return DigestOf(given); }, source);
}

Result<Drawing> ReadDrawing(const std::string& shape_id, const ShapeSource& source,
                            const Limits& limits, std::int64_t pixels_left) {
  const Upload upload{shape_id, limits, pixels_left};
  Drawing drawing = TRY(std::visit([&](const auto& given) { return Read(upload, given); }, source));
  drawing.id = shape_id;
  drawing.digest = SourceDigest(source);
  return drawing;
}

}  // namespace posespace
