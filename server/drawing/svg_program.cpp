// SPDX-License-Identifier: Apache-2.0
// posespace-svg: reads an SVG document from its input and writes its pixels; see svg.h for why this
// is a program of its own.  What it writes:
//
//   drawn WIDTH HEIGHT ORIGIN_X ORIGIN_Y SCALE CANVAS_WIDTH CANVAS_HEIGHT WARNINGS
//   one line for each warning
//   WIDTH x HEIGHT pixels, RGBA, straight alpha
// or
//   refused undecodable|too_large|empty MESSAGE
#include <librsvg/rsvg.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr std::size_t kMaxDocumentBytes = 32 << 20;
constexpr double kMaxCanvas = 1e6, kMinCanvas = 1e-6;  // user units
constexpr double kPage = 512.0;                        // the canvas of a document that names none
constexpr int kTexels = 1024;                          // along the longer side of what is drawn
constexpr int kLookTexels = 256;                       // when looking where that is
constexpr int kLooks = 3;
constexpr double kFillsCanvas = 0.95;  // from here on the drawing takes the whole canvas
constexpr double kMargin = 0.06;  // else it gets a clear margin, so that nobody sees paper in it

constexpr rlim_t kSeconds = 5, kMemory = rlim_t{1} << 30, kFiles = 64;

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
  void operator()(GError* error) const { g_error_free(error); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Handle = std::unique_ptr<RsvgHandle, Unref>;
using Surface = std::unique_ptr<cairo_surface_t, Unref>;

struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
};

[[noreturn]] void Refuse(const char* kind, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::printf("refused %s %s\n", kind, message.c_str());
  std::fflush(stdout);
  _exit(0);
}

void LimitYourself() {
  const auto limit = [](auto resource, rlim_t most) {
    const rlimit both{most, most};
    setrlimit(resource, &both);
  };
  limit(RLIMIT_CPU, kSeconds);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, kFiles);
#ifndef __SANITIZE_ADDRESS__  // which maps terabytes
  limit(RLIMIT_AS, kMemory);
#endif
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
}

std::string ReadInput() {
  std::string document;
  char buffer[1 << 16];
  while (const std::size_t count = std::fread(buffer, 1, sizeof(buffer), stdin)) {
    document.append(buffer, count);
  }
  return document;
}

// The document itself, unpacked when it is a gzip file.
std::string Unpacked(std::string document) {
  if (document.size() < 2 || document[0] != '\x1f' || document[1] != '\x8b') return document;
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) Refuse("undecodable", "it cannot be unpacked");
  stream.next_in = reinterpret_cast<Bytef*>(document.data());
  stream.avail_in = static_cast<uInt>(document.size());
  std::string unpacked;
  std::vector<char> buffer(1 << 16);
  for (int state = Z_OK; state != Z_STREAM_END;) {
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    state = inflate(&stream, Z_NO_FLUSH);
    if (state == Z_BUF_ERROR) Refuse("undecodable", "its gzip file is cut short");
    if (state != Z_OK && state != Z_STREAM_END) Refuse("undecodable", "its gzip file is damaged");
    unpacked.append(buffer.data(), buffer.size() - stream.avail_out);
    if (unpacked.size() > kMaxDocumentBytes) {
      Refuse("too_large", "it unpacks to more than 32 MiB");
    }
  }
  inflateEnd(&stream);
  return unpacked;
}

// What a person should know of the document: crude, but for words only.
std::vector<std::string> WarningsOf(std::string_view document) {
  int outside = 0;
  for (auto at = document.find("href"); at != document.npos; at = document.find("href", at + 4)) {
    const auto value = document.find_first_not_of(" \t\r\n=\"'", at + 4);
    const auto tag = document.rfind('<', at);
    if (value == document.npos || tag == document.npos) continue;
    const std::string_view name = document.substr(tag + 1, 12), target = document.substr(value, 5);
    const bool draws = name.find("image") != name.npos || name.find("Image") != name.npos ||
                       name.starts_with("use") || name.starts_with("svg:use");
    if (draws && !target.starts_with('#') && target != "data:") ++outside;
  }
  std::vector<std::string> warnings;
  if (outside > 0) {
    warnings.push_back((outside == 1 ? "1 thing that the document refers to outside itself was"
                                     : std::to_string(outside) +
                                           " things that the document refers to outside itself "
                                           "were") +
                       std::string(" not drawn"));
  }
  if (document.find("<text") != document.npos || document.find("<svg:text") != document.npos) {
    warnings.push_back(
        "text was drawn in the fonts of the service's machine; outlines of it are "
        "the same everywhere");
  }
  return warnings;
}

Handle Load(const std::string& document) {
  GError* error = nullptr;
  const std::unique_ptr<GInputStream, Unref> stream(g_memory_input_stream_new_from_data(
      document.data(), static_cast<gssize>(document.size()), nullptr));
  // Without a base file nothing outside the document can be named.
  Handle handle(rsvg_handle_new_from_stream_sync(stream.get(), nullptr, RSVG_HANDLE_FLAGS_NONE,
                                                 nullptr, &error));
  if (handle == nullptr) {
    const std::unique_ptr<GError, Unref> owned(error);
    Refuse("undecodable", "this is no SVG document, or a damaged one: " +
                              std::string(error != nullptr ? error->message : "unknown"));
  }
  rsvg_handle_set_dpi(handle.get(), 96.0);
  return handle;
}

bool IsSound(const Box& box) {
  return std::isfinite(box.x) && std::isfinite(box.y) && box.width >= kMinCanvas &&
         box.height >= kMinCanvas && box.width <= kMaxCanvas && box.height <= kMaxCanvas &&
         std::abs(box.x) <= kMaxCanvas && std::abs(box.y) <= kMaxCanvas;
}

// The part of the plane that a document shows, in user units.
struct Canvas {
  Box box;
  RsvgRectangle viewport{};  // what librsvg is to draw into for user units to stay as they are
};

// A length of 100 %, which is also what no length means.
bool IsAll(const RsvgLength& length) {
  return length.unit == RSVG_UNIT_PERCENT && length.length == 1.0;
}

Canvas CanvasOf(RsvgHandle* handle) {
  gboolean has_width = FALSE, has_height = FALSE, has_box = FALSE;
  RsvgLength width{}, height{};
  RsvgRectangle box{};
  rsvg_handle_get_intrinsic_dimensions(handle, &has_width, &width, &has_height, &height, &has_box,
                                       &box);
  Canvas canvas{{box.x, box.y, box.width, box.height}, box};
  if (has_box == FALSE) {
    canvas = {{0.0, 0.0, kPage, kPage}, {0.0, 0.0, kPage, kPage}};
    if (rsvg_handle_get_intrinsic_size_in_pixels(handle, &canvas.box.width, &canvas.box.height) !=
        FALSE) {
      canvas.viewport.width = canvas.box.width;
      canvas.viewport.height = canvas.box.height;
    } else if (!IsAll(width) || !IsAll(height)) {
      Refuse("undecodable",
             "its canvas has no size: give it a viewBox, or a width and a height in px");
    } else {
      RsvgRectangle ink{};
      rsvg_handle_get_geometry_for_layer(handle, nullptr, &canvas.viewport, &ink, nullptr, nullptr);
      if (ink.width <= 0.0 || ink.height <= 0.0) Refuse("empty", "it draws nothing");
      canvas.box = {ink.x, ink.y, ink.width, ink.height};
    }
  }
  if (!IsSound(canvas.box)) {
    char text[160];
    std::snprintf(text, sizeof(text),
                  "its canvas of %g x %g user units at (%g, %g) is empty or reaches beyond 1e6",
                  canvas.box.width, canvas.box.height, canvas.box.x, canvas.box.y);
    Refuse("too_large", text);
  }
  return canvas;
}

// A part of the canvas as pixels.
struct Picture {
  Surface surface;
  int width = 0, height = 0;
  double scale = 1.0;  // pixels per user unit

  const std::uint32_t* row(int y) const {
    const unsigned char* data = cairo_image_surface_get_data(surface.get());
    return reinterpret_cast<const std::uint32_t*>(
        data + static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface.get()));
  }
};

Picture Draw(RsvgHandle* handle, const Canvas& canvas, const Box& part, int texels) {
  Picture picture;
  picture.scale = texels / std::max(part.width, part.height);
  picture.width = std::max(1, static_cast<int>(std::ceil(part.width * picture.scale)));
  picture.height = std::max(1, static_cast<int>(std::ceil(part.height * picture.scale)));
  picture.surface.reset(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, picture.width, picture.height));
  const std::unique_ptr<cairo_t, Unref> context(cairo_create(picture.surface.get()));
  cairo_scale(context.get(), picture.scale, picture.scale);
  cairo_translate(context.get(), -part.x, -part.y);
  GError* error = nullptr;
  if (rsvg_handle_render_document(handle, context.get(), &canvas.viewport, &error) == FALSE) {
    const std::unique_ptr<GError, Unref> owned(error);
    Refuse("undecodable",
           "it cannot be drawn: " + std::string(error != nullptr ? error->message : "unknown"));
  }
  cairo_surface_flush(picture.surface.get());
  return picture;
}

// The box around what a picture shows of a part of the canvas, a pixel wider on each side.
std::optional<Box> Shown(const Picture& picture, const Box& part) {
  int left = picture.width, right = -1, top = picture.height, bottom = -1;
  for (int y = 0; y < picture.height; ++y) {
    const std::uint32_t* row = picture.row(y);
    for (int x = 0; x < picture.width; ++x) {
      if (row[x] >> 24 == 0) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = y;
    }
  }
  if (right < 0) return std::nullopt;
  const double pixel = 1.0 / picture.scale;
  const double x = std::max(part.x, part.x + (left - 1) * pixel);
  const double y = std::max(part.y, part.y + (top - 1) * pixel);
  return Box{x, y, std::min(part.x + part.width, part.x + (right + 2) * pixel) - x,
             std::min(part.y + part.height, part.y + (bottom + 2) * pixel) - y};
}

// The part of the canvas that is drawn on, with a margin; all of it when it is filled.
Box PartDrawnOn(RsvgHandle* handle, const Canvas& canvas) {
  const Box& whole = canvas.box;
  Box part = whole;
  for (int look = 0; look < kLooks; ++look) {
    const auto shown = Shown(Draw(handle, canvas, part, kLookTexels), part);
    if (!shown) Refuse("empty", "it draws nothing on its canvas");
    const bool much_smaller =
        2.0 * std::max(shown->width, shown->height) < std::max(part.width, part.height);
    part = *shown;
    if (!much_smaller) break;
  }
  if (part.width >= kFillsCanvas * whole.width && part.height >= kFillsCanvas * whole.height) {
    return whole;
  }
  const double x = std::max(whole.x, part.x - kMargin * part.width);
  const double y = std::max(whole.y, part.y - kMargin * part.height);
  return {x, y, std::min(whole.x + whole.width, part.x + (1.0 + kMargin) * part.width) - x,
          std::min(whole.y + whole.height, part.y + (1.0 + kMargin) * part.height) - y};
}

// Premultiplied native-endian ARGB to straight RGBA.
std::vector<std::uint8_t> StraightPixels(const Picture& picture) {
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * static_cast<std::size_t>(picture.width) * picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint32_t* row = picture.row(y);
    for (int x = 0; x < picture.width; ++x) {
      const std::uint32_t alpha = row[x] >> 24;
      for (const int shift : {16, 8, 0}) {
        const std::uint32_t sample = row[x] >> shift & 255;
        rgba.push_back(static_cast<std::uint8_t>(
            alpha == 0 ? 0 : std::min<std::uint32_t>(255, (255 * sample + alpha / 2) / alpha)));
      }
      rgba.push_back(static_cast<std::uint8_t>(alpha));
    }
  }
  return rgba;
}

}  // namespace

int main() {
  LimitYourself();
  const std::string document = Unpacked(ReadInput());
  const std::vector<std::string> warnings = WarningsOf(document);
  const Handle handle = Load(document);
  const Canvas canvas = CanvasOf(handle.get());
  const Box part = PartDrawnOn(handle.get(), canvas);
  const Picture picture = Draw(handle.get(), canvas, part, kTexels);
  const std::vector<std::uint8_t> rgba = StraightPixels(picture);
  std::printf("drawn %d %d %.17g %.17g %.17g %.17g %.17g %zu\n", picture.width, picture.height,
              part.x, part.y, picture.scale, canvas.box.width, canvas.box.height, warnings.size());
  for (const std::string& warning : warnings) std::printf("%s\n", warning.c_str());
  std::fwrite(rgba.data(), 1, rgba.size(), stdout);
  std::fflush(stdout);
  _exit(0);  // what is left belongs to the system
}
