#pragma once

#include <exception>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "engine/pipeline/ordered_queue.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// A frame that was read, or could not be.
struct ReadFrame {
  int index = 0;
  slam::FrameInput frame;
  std::string error;  ///< why it could not be read; empty otherwise
};

/// Frames begin, begin + step, ... before end, read ahead on a thread of its own when `threaded`.
class FrameReader {
 public:
  /// `step` is 1 or -1.
  FrameReader(Sequence& sequence, int begin, int end, bool threaded, int step = 1);
  ~FrameReader();
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// Nothing after the last one. Throws what reading threw beside UserErrors.
  std::optional<ReadFrame> next();

 private:
  void read_all();

  Sequence& sequence_;
  int next_;
  int end_;
  int step_;
  OrderedQueue<ReadFrame> queue_;
  std::exception_ptr failure_;  ///< written before close(), read after the last pop()
  std::thread thread_;
};

/// A finished picture, CV_8UC3 BGR.
struct Picture {
  int index = 0;
  cv::Mat bgr;
};

/// Hands pictures to `write` in order, on a thread of its own when `threaded`.
class PictureWriter {
 public:
  PictureWriter(std::function<void(const Picture&)> write, bool threaded);
  ~PictureWriter();
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;

  /// Throws what writing an earlier picture threw.
  void put(Picture picture);
  /// Waits until all is written; throws what went wrong there.
  void finish();

 private:
  void write_all();

  std::function<void(const Picture&)> write_;
  OrderedQueue<Picture> queue_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace planecast::engine
