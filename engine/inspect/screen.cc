#include "engine/inspect/screen.h"

namespace planecast::engine {
namespace {

constexpr float kFontPx = 16.0F;
constexpr int kSettled = 4;  ///< pictures after which ImGui's automatic sizes stay
const cv::Scalar kBackground(31, 27, 24);

}  // namespace

InspectScreen::InspectScreen(InspectWindow& window, FramePictures& pictures)
    : window_(window), pictures_(pictures), canvas_(kFontPx) {}

cv::Mat InspectScreen::draw(int width, int height, float step_s) {
  canvas_.gui().begin(width, height, step_s);
  window_.draw();
  const cv::Mat& picture = pictures_.picture(window_.view().objects);
  if (shown_picture_ != pictures_.revision()) canvas_.set_picture(kFrameTexture, picture);
  shown_picture_ = pictures_.revision();
  cv::Mat screen(height, width, CV_8UC3, kBackground);
  lay_over(canvas_.end(), screen);
  return screen;
}

cv::Mat inspect_screenshot(InspectScreen& screen, int width, int height) {
  for (int i = 1; i < kSettled; ++i) screen.draw(width, height);
  return screen.draw(width, height);
}

}  // namespace planecast::engine
