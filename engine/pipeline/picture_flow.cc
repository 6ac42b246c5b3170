#include "engine/pipeline/picture_flow.h"

#include <algorithm>
#include <utility>

#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr std::size_t kQueueLength = 4;  ///< pictures: enough to hide jitter, little memory
constexpr std::size_t kMostReadAhead = 16;

/// Frames to read ahead: as many as fit 16 MB of colour, so that small ones are read while tracking
/// waits for the map.
std::size_t frames_read_ahead(const slam::Camera& camera) {
  constexpr std::size_t kBytes = 16U << 20U;
  const std::size_t frame = 3 * static_cast<std::size_t>(std::max(camera.width, 1)) *
                            static_cast<std::size_t>(std::max(camera.height, 1));
  return std::clamp(kBytes / frame, kQueueLength, kMostReadAhead);
}

ReadFrame read_frame(Sequence& sequence, int index) {
  ReadFrame result;
  result.index = index;
  try {
    result.frame = sequence.read(index);
  } catch (const UserError& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace

FrameReader::FrameReader(Sequence& sequence, int begin, int end, bool threaded, int step)
    : sequence_(sequence),
      next_(begin),
      end_(end),
      step_(step),
      queue_(frames_read_ahead(sequence.camera())) {
  if (threaded) thread_ = std::thread([this] { read_all(); });
}

FrameReader::~FrameReader() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

std::optional<ReadFrame> FrameReader::next() {
  if (!thread_.joinable()) {
    if (next_ == end_) return std::nullopt;
    ReadFrame frame = read_frame(sequence_, next_);
    next_ += step_;
    return frame;
  }
  std::optional<ReadFrame> frame = queue_.pop();
  if (!frame && failure_) std::rethrow_exception(failure_);
  return frame;
}

void FrameReader::read_all() {
  try {
    for (; next_ != end_; next_ += step_) {
      if (!queue_.push(read_frame(sequence_, next_))) break;
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  queue_.close();
}

PictureWriter::PictureWriter(std::function<void(const Picture&)> write, bool threaded)
    : write_(std::move(write)), queue_(kQueueLength) {
  if (threaded) thread_ = std::thread([this] { write_all(); });
}

PictureWriter::~PictureWriter() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void PictureWriter::put(Picture picture) {
  if (!thread_.joinable()) {
    write_(picture);
  } else if (!queue_.push(std::move(picture))) {
    finish();
  }
}

void PictureWriter::finish() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void PictureWriter::write_all() {
  try {
    while (const std::optional<Picture> picture = queue_.pop()) write_(*picture);
  } catch (...) {
    failure_ = std::current_exception();
    queue_.close();
  }
}

}  // namespace planecast::engine
