#include "engine/sequence/frame_options.h"

#include <cstdio>

#include "engine/user_error.h"

namespace planecast::engine {

void parse_frames(const std::string& text, SequenceOptions& options) {
  int first = 0;
  int end = -1;
  char rest = 0;
  const bool both = std::sscanf(text.c_str(), "%d:%d%c", &first, &end, &rest) == 2;
  const bool from =
      !both && std::sscanf(text.c_str(), "%d:%c", &first, &rest) == 1 && text.back() == ':';
  const bool to = !both && !from && std::sscanf(text.c_str(), ":%d%c", &end, &rest) == 1;
  if (to) first = 0;
  if ((!both && !from && !to) || first < 0 || (!from && end <= first)) {
    throw UserError("--frames " + text + ": expected A:B with 0 <= A < B");
  }
  options.first_frame = first;
  options.end_frame = from ? -1 : end;
}

cv::Size parse_size(const std::string& text) {
  constexpr int kMost = 16384;
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 16 ||
      height < 16 || width > kMost || height > kMost) {
    throw UserError("--size " + text + ": expected WxH in pixels, as 640x480");
  }
  return {width, height};
}

}  // namespace planecast::engine
