#include "engine/output/video.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <regex>
#include <stdexcept>

#include "engine/output/atomic_file.h"
#include "engine/output/video_join.h"
#include "engine/output/video_segment.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

/// Largest side that H.264 level 6.2 knows.
constexpr int kMaxSide = 16384;

std::string settings_text(cv::Size size, FrameRate rate, const VideoOptions& options) {
  return fmt::format("{}x{} {}/{} crf {} {} segments of {}\n{}\n", size.width, size.height,
                     rate.numerator, rate.denominator, options.crf, options.preset,
                     options.segment_frames, options.content_key);
}

/// Removes what an earlier run left, but nothing that is not ours.
void remove_segments(const fs::path& folder) {
  static const std::regex kOurs("[0-9]{6}\\.mp4(\\.part)?|settings\\.txt(\\.part)?");
  std::error_code error;
  std::vector<fs::path> ours;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (std::regex_match(entry.path().filename().string(), kOurs)) ours.push_back(entry.path());
  }
  for (const fs::path& file : ours) fs::remove(file, error);
  if (fs::is_empty(folder, error) && !error) fs::remove(folder, error);
}

}  // namespace

FrameRate exact_frame_rate(double fps) {
  for (const int whole : {24, 30, 60, 120}) {
    const double ntsc = whole * 1000.0 / 1001.0;
    if (std::abs(fps - ntsc) < 1e-3) {
      return {whole * 1000, 1001};
    }
  }
  const int thousandths = static_cast<int>(std::lround(fps * 1000.0));
  const int divisor = std::gcd(thousandths, 1000);
  return {thousandths / divisor, 1000 / divisor};
}

VideoWriter::VideoWriter(const fs::path& path, int width, int height, double fps,
                         const VideoOptions& options)
    : path_(path),
      folder_(path.parent_path() / "segments"),
      size_(width, height),
      options_(options) {
  if (width <= 0 || height <= 0 || width > kMaxSide || height > kMaxSide) {
    throw UserError(
        fmt::format("{}: a video cannot be {}x{} pixels", path.string(), width, height));
  }
  if (!(fps >= 0.001 && fps <= 1000.0)) {
    throw UserError(fmt::format("{}: {} is not a possible frame rate", path.string(), fps));
  }
  if (options_.segment_frames < 1) throw std::invalid_argument("a segment needs a frame");
  rate_ = exact_frame_rate(fps);
  // x264 and swscale tell their settings and capabilities on stderr otherwise.
  av_log_set_level(AV_LOG_ERROR);
  prepare_folder();
}

VideoWriter::~VideoWriter() = default;

fs::path VideoWriter::segment_path(int index) const {
  return folder_ / fmt::format("{:06}.mp4", index);
}

void VideoWriter::prepare_folder() {
  const std::string settings = settings_text(size_, rate_, options_);
  const fs::path settings_path = folder_ / "settings.txt";
  std::error_code error;
  const bool usable =
      options_.resume && fs::exists(settings_path, error) && read_file(settings_path) == settings;
  if (usable) {
    while (fs::exists(segment_path(first_missing_segment_), error)) ++first_missing_segment_;
    next_segment_ = first_missing_segment_;
    return;
  }
  remove_segments(folder_);
  make_folder(folder_);
  write_file(settings_path, settings);
}

void VideoWriter::write(const cv::Mat& bgr) {
  if (bgr.type() != CV_8UC3 || bgr.size() != size_) {
    throw std::invalid_argument("a video frame is CV_8UC3 of the video's size");
  }
  if (!segment_) {
    segment_ = std::make_unique<Segment>(segment_path(next_segment_), size_, rate_, options_);
  }
  segment_->write(bgr);
  if (++frames_in_segment_ == options_.segment_frames) close_segment();
}

void VideoWriter::close_segment() {
  segment_->finish();
  segment_.reset();
  frames_in_segment_ = 0;
  ++next_segment_;
}

void VideoWriter::finish() {
  if (segment_) close_segment();
  if (next_segment_ == 0) throw UserError(fmt::format("{}: has no frames", path_.string()));
  std::vector<fs::path> segments;
  for (int index = 0; index < next_segment_; ++index) segments.push_back(segment_path(index));
  join_segments(segments, rate_, path_);
  remove_segments(folder_);
}

}  // namespace planecast::engine
