#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <vector>

#include "engine/pipeline/ordered_queue.h"
#include "engine/pipeline/picture_flow.h"
#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// A frame with the content drawn into it.
struct PaintedFrame {
  int index = 0;
  bool readable = true;
  cv::Mat bgr;  ///< CV_8UC3; empty when the frame could not be read
  bool has_content = false;
  bool by_processor = false;  ///< the content was drawn without OpenGL
  StageTimes times;           ///< empty when nothing was to be drawn
  std::string renderer;       ///< the driver's own description
  std::exception_ptr failure;
};

/// Paints frames on several threads and gives them back in the order they came. Frame n goes to
/// thread n modulo their number, and each picture depends on its frame alone, so the number of
/// threads changes no byte.
class PaintingThreads {
 public:
  using Paint = std::function<PaintedFrame(const ReadFrame&)>;

  /// Each thread calls `make` once and keeps what it made, such as a renderer, to itself. With one
  /// thread everything happens in put(), in the caller's.
  PaintingThreads(std::function<Paint()> make, int threads);
  ~PaintingThreads();
  PaintingThreads(const PaintingThreads&) = delete;
  PaintingThreads& operator=(const PaintingThreads&) = delete;

  bool full() const;
  bool empty() const { return put_ == taken_; }
  /// Call only when not full.
  void put(ReadFrame frame);
  /// Waits for the oldest frame that was put in; throws what painting it threw. Call only when not
  /// empty.
  PaintedFrame take();

 private:
  struct Worker {
    Worker();
    OrderedQueue<ReadFrame> frames;
    OrderedQueue<PaintedFrame> painted;
    std::thread thread;
  };

  void work(Worker& worker) const;

  std::function<Paint()> make_;
  std::vector<std::unique_ptr<Worker>> workers_;  ///< none: all in the caller's thread
  Paint own_;
  std::deque<PaintedFrame> own_painted_;
  std::size_t put_ = 0;
  std::size_t taken_ = 0;
};

}  // namespace planecast::engine
