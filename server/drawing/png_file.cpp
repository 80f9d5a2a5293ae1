// SPDX-License-Identifier: Apache-2.0
#include "drawing/png_file.h"

#include <png.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "drawing/picture_limits.h"

namespace posespace {
namespace {

// Deflate never shrinks data more than 1032 times (zlib, "Technical Details"), so a file that
// claims more pixels than its bytes could hold is refused before memory is taken for them.
constexpr double kMaxDeflateRatio = 1032.0;

// What ancillary chunks may occupy once inflated; we read only tRNS, which needs 256 bytes.
constexpr png_alloc_size_t kMaxChunkBytes = 1 << 20;

// Chunks that libpng knows and we do not need: skipped, never inflated or stored.  Samples are
// taken as sRGB whatever gAMA, cHRM or iCCP say, as game engines and image libraries do.
constexpr png_byte kUnusedChunks[] =
    "bKGD\0cHRM\0eXIf\0gAMA\0hIST\0iCCP\0iTXt\0oFFs\0pCAL\0pHYs\0sBIT\0sCAL\0sPLT\0sRGB\0sTER\0"
    "tEXt\0tIME\0zTXt";
constexpr int kNumUnusedChunks = sizeof(kUnusedChunks) / 5;

// Reads one PNG.  libpng reports errors by longjmp, which runs no destructors: every member that
// enters it keeps only trivial locals, and memory belongs to the caller or to this object.
class PngReader {
 public:
  explicit PngReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &OnError, &OnWarning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  bool ok() const { return info_ != nullptr; }

  // Reads everything before the pixels and asks for 8-bit RGBA.
  bool ReadHeader() {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_read_fn(png_, this, &OnRead);
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // DecodeLimits decides instead
    png_set_chunk_malloc_max(png_, kMaxChunkBytes);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, kUnusedChunks, kNumUnusedChunks);
    png_read_info(png_, info_);
    png_set_expand(png_);    // palette and few-bit grey to 8 bits, tRNS to alpha
    png_set_scale_16(png_);  // 16 bits to the nearest 8
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 0xff, PNG_FILLER_AFTER);
    return true;
  }

  std::int64_t width() const { return png_get_image_width(png_, info_); }
  std::int64_t height() const { return png_get_image_height(png_, info_); }
  int bits_per_pixel() const {
    return png_get_bit_depth(png_, info_) * png_get_channels(png_, info_);
  }

  // Reads the pixels into height() rows of 4 * width() bytes, and the end of the file.
  bool ReadPixels(std::uint8_t** rows) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != 4 * static_cast<std::size_t>(width())) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  Error Failure() const {
    return {ErrorCode::kImageUndecodable,
            cut_short_ ? std::string("the PNG file is cut short")
                       : "the PNG file is damaged: " + std::string(message_),
            {}};
  }

 private:
  static void OnRead(png_structp png, png_bytep to, std::size_t size) {
    auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
    if (size > self->bytes_.size() - self->offset_) {
      self->cut_short_ = true;
      png_error(png, "cut short");
    }
    std::memcpy(to, self->bytes_.data() + self->offset_, size);
    self->offset_ += size;
  }
  static void OnError(png_structp png, png_const_charp message) {
    auto* self = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(self->message_, sizeof(self->message_), "%s", message);
    png_longjmp(png, 1);
  }
  static void OnWarning(png_structp, png_const_charp) {}

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::span<const std::uint8_t> bytes_;
  std::size_t offset_ = 0;
  bool cut_short_ = false;
  char message_[160] = "unexpected row size";
};

}  // namespace

Result<Image> ReadPng(std::span<const std::uint8_t> bytes, std::int64_t max_pixels) {
  PngReader reader(bytes);
  if (!reader.ok()) return Error{ErrorCode::kInternal, "libpng could not be started", {}};
  if (!reader.ReadHeader()) return reader.Failure();

  const std::int64_t width = reader.width(), height = reader.height();  // each below 2^31
  TRY(CheckPixels(width, height, max_pixels));
  const double raw_bytes = 0.125 * static_cast<double>(width * height) * reader.bits_per_pixel();
  if (raw_bytes > kMaxDeflateRatio * static_cast<double>(bytes.size())) {
    return CannotHold("PNG", bytes.size(), width, height);
  }

  Image image = ImageOf(width, height);
  std::vector<std::uint8_t*> rows(height);
  for (int y = 0; y < image.height; ++y) rows[y] = image.at(0, y);
  if (!reader.ReadPixels(rows.data())) return reader.Failure();
  return image;
}

std::vector<std::uint8_t> EncodePng(const Image& image) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * image.height;
  if (image.width <= 0 || image.height <= 0 || image.rgba.size() != 4 * pixels) return {};
  png_image png{};  // libpng's simplified writer: reports by value, never by longjmp to us
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGBA;
  png.flags = PNG_IMAGE_FLAG_FAST;  // drawn frames: 4 times faster for half as many bytes again
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr) == 0) {
    return {};
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}

}  // namespace posespace
