// SPDX-License-Identifier: Apache-2.0
#include "drawing/jpeg_file.h"

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "drawing/exif_orientation.h"
#include "drawing/picture_limits.h"

// clang-format off
#include <jpeglib.h>  // needs FILE, and says how jerror.h numbers its messages
#include <jerror.h>
// clang-format on

namespace posespace {
namespace {

// Huffman codes take at least one bit for each block of 8 x 8, so a file that claims more pixels
// than its bytes could hold is refused before memory is taken for them.
constexpr double kMaxPixelsPerByte = 8.0 * 64.0;

// Each scan of a progressive file may cost a pass over all its pixels and next to no bytes: what is
// accepted is this many pixels passed over, and enough scans for any encoder.
constexpr std::int64_t kMaxScannedPixels = 1'000'000'000;
constexpr std::int64_t kMinScansAccepted = 24, kMaxScansAccepted = 1'000;

constexpr std::string_view kExifMarker{"Exif\0\0", 6};

// Reads one JPEG.  libjpeg reports errors by longjmp, which runs no destructors: every member that
// enters it keeps only trivial locals, and memory belongs to the caller or to this object.
class JpegReader {
 public:
  explicit JpegReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = &OnError;
    errors_.emit_message = &OnMessage;
    jpeg_.client_data = this;
    progress_.progress_monitor = &OnProgress;
  }
  ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  // Reads everything before the pixels and asks for 8-bit RGBA, or CMYK where it is that.
  bool ReadHeader() {
    if (setjmp(jump_)) return false;
    jpeg_create_decompress(&jpeg_);
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, bytes_.data(), bytes_.size());
    jpeg_save_markers(&jpeg_, JPEG_APP0 + 1, 0xffff);  // EXIF
    jpeg_read_header(&jpeg_, TRUE);
    if (is_cmyk()) {
      jpeg_.out_color_space = JCS_CMYK;
    } else if (jpeg_.jpeg_color_space == JCS_UNKNOWN) {
      std::snprintf(message_, sizeof(message_), "%d colour components", jpeg_.num_components);
      return false;
    } else {
      jpeg_.out_color_space = JCS_EXT_RGBA;
    }
    max_scans_ = std::clamp(kMaxScannedPixels / std::max<std::int64_t>(1, width() * height()),
                            kMinScansAccepted, kMaxScansAccepted);
    return true;
  }

  std::int64_t width() const { return jpeg_.image_width; }
  std::int64_t height() const { return jpeg_.image_height; }
  bool is_huffman_coded() const { return jpeg_.arith_code == 0; }
  bool is_cmyk() const {
    return jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK;
  }
  bool is_inverted() const { return jpeg_.saw_Adobe_marker != 0; }  // as Photoshop writes CMYK

  int Orientation() const {
    for (auto* marker = jpeg_.marker_list; marker != nullptr; marker = marker->next) {
      const std::span<const std::uint8_t> data(marker->data, marker->data_length);
      if (data.size() < kExifMarker.size()) continue;
      if (!std::equal(kExifMarker.begin(), kExifMarker.end(), data.begin())) continue;
      return ExifOrientation(data.subspan(kExifMarker.size()));
    }
    return 1;
  }

  // Reads the pixels, 4 bytes each, and the end of the file.
  bool ReadPixels(std::uint8_t* pixels) {
    if (setjmp(jump_)) return false;
    jpeg_start_decompress(&jpeg_);
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = pixels + static_cast<std::size_t>(jpeg_.output_scanline) * 4 * width();
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return true;
  }

  Error Failure() const {
    return {ErrorCode::kImageUndecodable,
            cut_short_ ? std::string("the JPEG file is cut short")
                       : "the JPEG file is damaged or of an unknown kind: " + std::string(message_),
            {}};
  }

 private:
  static JpegReader* Of(j_common_ptr jpeg) { return static_cast<JpegReader*>(jpeg->client_data); }

  static void OnError(j_common_ptr jpeg) {
    JpegReader* const self = Of(jpeg);
    char text[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, text);
    std::snprintf(self->message_, sizeof(self->message_), "%.150s", text);
    std::longjmp(self->jump_, 1);
  }

  // libjpeg paints grey where data are missing or make no sense, and only warns of it.
  static void OnMessage(j_common_ptr jpeg, int level) {
    if (level >= 0) return;  // a trace
    switch (jpeg->err->msg_code) {
      case JWRN_JPEG_EOF:
        Of(jpeg)->cut_short_ = true;
        OnError(jpeg);
        break;
      case JWRN_HIT_MARKER:
      case JWRN_HUFF_BAD_CODE:
      case JWRN_MUST_RESYNC:
      case JWRN_ARITH_BAD_CODE:
        OnError(jpeg);
        break;
      default:  // oddities that cost no pixel
        break;
    }
  }

  static void OnProgress(j_common_ptr jpeg) {
    JpegReader* const self = Of(jpeg);
    if (self->jpeg_.input_scan_number <= self->max_scans_) return;
    std::snprintf(self->message_, sizeof(self->message_), "more than %d scans",
                  static_cast<int>(self->max_scans_));
    std::longjmp(self->jump_, 1);
  }

  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf jump_{};
  std::span<const std::uint8_t> bytes_;
  std::int64_t max_scans_ = 0;
  bool cut_short_ = false;
  char message_[160] = "";
};

// Inks to light, without a colour profile.
void ConvertCmyk(Image* image, bool inverted) {
  for (std::size_t k = 0; k < image->rgba.size(); k += 4) {
    std::uint8_t* pixel = image->rgba.data() + k;
    const int flip = inverted ? 0 : 255;
    const int paper = std::abs(flip - pixel[3]);
    for (int c = 0; c < 3; ++c) {
      pixel[c] = static_cast<std::uint8_t>((std::abs(flip - pixel[c]) * paper + 127) / 255);
    }
    pixel[3] = 255;
  }
}

}  // namespace

Result<DecodedImage> ReadJpeg(std::span<const std::uint8_t> bytes, std::int64_t max_pixels) {
  JpegReader reader(bytes);
  if (!reader.ReadHeader()) return reader.Failure();
  const std::int64_t width = reader.width(), height = reader.height();  // each below 2^16
  TRY(CheckPixels(width, height, max_pixels));
  if (reader.is_huffman_coded() &&
      static_cast<double>(width * height) > kMaxPixelsPerByte * static_cast<double>(bytes.size())) {
    return CannotHold("JPEG", bytes.size(), width, height);
  }

  const int orientation = reader.Orientation();  // libjpeg forgets its markers with the last row
  Image image = ImageOf(width, height);
  if (!reader.ReadPixels(image.rgba.data())) return reader.Failure();
  std::vector<std::string> warnings;
  if (reader.is_cmyk()) {
    ConvertCmyk(&image, reader.is_inverted());
    warnings.push_back("the picture is CMYK: its colours were converted without a colour profile");
  }
  if (orientation != 1) {
    warnings.push_back("the picture was turned upright as its EXIF orientation, " +
                       std::to_string(orientation) + ", says");
  }
  return DecodedImage{Upright(std::move(image), orientation), std::move(warnings)};
}

}  // namespace posespace
