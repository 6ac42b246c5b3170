#include "engine/gui/gui_canvas.h"

#include <opencv2/imgproc.hpp>

#include "engine/assets.h"

namespace planecast::engine {

GuiCanvas::GuiCanvas(float font_px) : gui_(font_px), painter_(asset("shaders").string()) {
  painter_.set_texture(kFontTexture, gui_.font_image());
}

void GuiCanvas::set_picture(std::uintptr_t id, const cv::Mat& bgr) {
  render::ImageU8 image(bgr.cols, bgr.rows, 3);
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, image.pixels.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  painter_.set_texture(id, image);
}

cv::Mat GuiCanvas::end() {
  render::ImageU8 image = painter_.draw(gui_.end());
  return cv::Mat(image.height, image.width, CV_8UC4, image.pixels.data()).clone();
}

void lay_over(const cv::Mat& rgba_premultiplied, cv::Mat& bgr) {
  CV_Assert(rgba_premultiplied.size() == bgr.size() && bgr.type() == CV_8UC3);
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* from = rgba_premultiplied.ptr<cv::Vec4b>(y);
    auto* to = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; ++x) {
      const int through = 255 - from[x][3];
      if (through == 255) continue;
      for (int c = 0; c < 3; ++c) {
        const int mixed = from[x][2 - c] + (to[x][c] * through + 127) / 255;
        to[x][c] = static_cast<std::uint8_t>(std::min(mixed, 255));
      }
    }
  }
}

}  // namespace planecast::engine
