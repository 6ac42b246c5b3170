#include "engine/sequence/jpeg_file.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>
// Uses the two above without including them.
#include <jpeglib.h>

namespace planecast::engine {
namespace {

constexpr int kExifMarker = JPEG_APP0 + 1;

/// What libjpeg does instead of ending the program or writing to standard error.
struct Failure {
  jpeg_error_mgr manager;  ///< first, so that libjpeg's pointer to it is one to this
  std::jmp_buf out;
};

[[noreturn]] void give_up(j_common_ptr info) {
  std::longjmp(reinterpret_cast<Failure*>(info->err)->out, 1);
}

void warn(j_common_ptr info, int level) {
  if (level < 0) give_up(info);
}

void say_nothing(j_common_ptr) {}

class Decompressor {
 public:
  Decompressor() {
    info_.err = jpeg_std_error(&failure_.manager);
    failure_.manager.error_exit = give_up;
    failure_.manager.emit_message = warn;
    failure_.manager.output_message = say_nothing;
  }
  ~Decompressor() { jpeg_destroy_decompress(&info_); }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;

  /// Whether the header is of the common kind; size() is known then.
  bool read_header(const std::vector<std::uint8_t>& bytes) {
    if (setjmp(failure_.out) != 0) return false;
    jpeg_create_decompress(&info_);
    jpeg_mem_src(&info_, bytes.data(), static_cast<unsigned long>(bytes.size()));
    jpeg_save_markers(&info_, kExifMarker, 1);
    if (jpeg_read_header(&info_, TRUE) != JPEG_HEADER_OK) return false;
    return info_.marker_list == nullptr && info_.num_components == 3 &&
           info_.jpeg_color_space == JCS_YCbCr;
  }
  cv::Size size() const {
    return {static_cast<int>(info_.image_width), static_cast<int>(info_.image_height)};
  }
  bool read_pixels(cv::Mat& bgr) {
    if (setjmp(failure_.out) != 0) return false;
    info_.out_color_space = JCS_EXT_BGR;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = bgr.ptr(static_cast<int>(info_.output_scanline));
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

 private:
  jpeg_decompress_struct info_{};
  Failure failure_{};
};

}  // namespace

cv::Mat decode_common_jpeg(const std::vector<std::uint8_t>& bytes) {
  Decompressor decompressor;
  if (!decompressor.read_header(bytes)) return {};
  cv::Mat bgr(decompressor.size(), CV_8UC3);
  if (!decompressor.read_pixels(bgr)) return {};
  return bgr;
}

}  // namespace planecast::engine
